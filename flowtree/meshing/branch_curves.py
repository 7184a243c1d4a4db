"""The axes of all living branches as curves: which leaves which, and what lies at an arc length of one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flowtree import check
from flowtree.meshing.branch_axes import BranchAxes, Floats, Ints, unit
from flowtree.meshing.trace_chains import Chains, trace_chains
from flowtree.meshing.transport_frames import transport_frames
from flowtree.model.skeleton import Skeleton

_THINNEST = 1e-5  # of the tree's extent; thinner tubes would collapse in float32
_SAME_PLACE = 1e-6  # of the tree's extent
_LOST = 1e-6  # a direction shorter than this is none


@dataclass(frozen=True)
class BranchCurves:
    """Polylines one behind the other, with rotation-minimising frames; branch 0 stands on the ground.

    Attributes:
        axes: rows from base to tip; a side branch begins with its fork.
        arc: (k,) [m], of the rows, from the branch's base.
        length: (c,) [m].
        tangent: (k, 3), unit, halfway between the directions of the segments that meet.
        one: (k, 3), unit, across the tangent.
        host: (c,), the branch that each leaves; -1 for branch 0.
        fork_arc: (c,) [m], where on it.
        offset: (c,), a coordinate that grows over all branches: that of an arc is ``offset[branch] + arc``.
    """

    axes: BranchAxes
    arc: Floats
    length: Floats
    tangent: Floats
    one: Floats
    host: Ints
    fork_arc: Floats
    offset: Floats

    def at(self, branch: Ints, arc: Floats) -> tuple[Floats, Floats, Ints]:
        """Centre (n, 3), radius (n,) and node (n,); beyond the ends the curve goes straight on."""
        above, share, beyond = self._locate(branch, arc)
        center, radius = self.axes.center, self.axes.radius
        place = center[above - 1] + share[:, None] * (center[above] - center[above - 1])
        way = unit(center[above] - center[above - 1])
        wide = radius[above - 1] + share * (radius[above] - radius[above - 1])
        return place + beyond[:, None] * way, wide, self.axes.node[above]

    def frames(self, branch: Ints, arc: Floats, reach: Floats) -> tuple[Floats, Floats, Floats]:
        """Right-handed unit vectors (n, 3), across, across and along the curve, seen over a reach (n,)."""
        above, share, _ = self._locate(branch, arc)
        segment = unit(self.axes.center[above] - self.axes.center[above - 1])
        way = unit(self.at(branch, arc + reach)[0] - self.at(branch, arc - reach)[0])
        along = np.where(np.sum(way * segment, axis=1, keepdims=True) > 0.0, way, segment)
        one = self.one[above - 1] + share[:, None] * (self.one[above] - self.one[above - 1])
        across = one - np.sum(one * along, axis=1, keepdims=True) * along
        lost = np.linalg.norm(across, axis=1) < 1e-3
        across[lost] = any_across(along[lost])
        across = unit(across)
        return across, np.cross(along, across), along

    def _locate(self, branch: Ints, arc: Floats) -> tuple[Ints, Floats, Floats]:
        """The row above (n,), the share of its segment (n,), and how far beyond the curve's ends (n,) [m]."""
        inside = np.clip(arc, 0.0, self.length[branch])
        place = self.offset[self.axes.chain] + self.arc
        above = np.searchsorted(place, self.offset[branch] + inside)
        above = np.clip(above, self.axes.first[branch] + 1, self.axes.last[branch])
        gap = self.arc[above] - self.arc[above - 1]
        share = np.clip((inside - self.arc[above - 1]) / np.maximum(gap, 1e-300), 0.0, 1.0)
        return above, share, arc - inside


def trace_curves(skeleton: Skeleton, *, device: str | None = None) -> BranchCurves:
    """The curves of all branches of some length.

    Repairs: radii below 1e-5 of the tree's extent are raised to it, nodes in the place of the one before them
    are passed over, branches of no length are left out (what grows on one grows on the branch that it left).

    Raises:
        InputError: every branch has no length.
    """
    chains = trace_chains(skeleton)
    points = skeleton.points.astype(np.float64)
    extent = float(np.max(np.ptp(points, axis=0)))
    thick = np.maximum(skeleton.radius.astype(np.float64), _THINNEST * extent)
    parent = skeleton.parent.astype(np.int64)
    begin = np.flatnonzero(np.diff(chains.chain, prepend=-1))
    radius, node = thick[chains.node], chains.node.copy()
    radius[begin] = thick[chains.sprout]
    node[begin] = chains.node[np.minimum(begin + 1, len(node) - 1)]
    whole = BranchAxes(points[chains.node], radius, chains.chain, node)

    gap = np.linalg.norm(np.diff(whole.center, axis=0, prepend=whole.center[:1]), axis=1)
    gap[begin] = 0.0
    kept = gap > _SAME_PLACE * extent
    alive = np.bincount(whole.chain[kept], minlength=len(begin)) > 0
    check.require(
        bool(alive.any()), "skeleton", "needs a branch of some length", "nodes in one place", "spread them"
    )
    kept[begin] = alive
    number = np.cumsum(alive) - 1
    rows = whole.at(kept)
    axes = BranchAxes(rows.center, rows.radius, number[rows.chain], rows.node)
    arc, length = axes.arc(), axes.length()
    host, fork_row = _hosts(chains, parent, begin, alive, np.cumsum(kept) - 1)
    tangent = axes.tangents()
    one, _ = transport_frames(axes.center, tangent, axes.chain, device=device)
    return BranchCurves(
        axes=axes,
        arc=arc,
        length=length,
        tangent=tangent,
        one=one,
        host=host,
        fork_arc=np.where(host >= 0, arc[fork_row], 0.0),
        offset=np.concatenate(([0.0], np.cumsum(length + extent + 9.0 * thick.max())[:-1])),
    )


def _hosts(chains: Chains, parent: Ints, begin: Ints, alive: np.ndarray, kept_row: Ints) -> tuple[Ints, Ints]:
    """The living branch (c,) that each living branch leaves, and the kept row (c,) where."""
    own = np.ones(len(chains.node), np.bool_)
    own[begin[1:]] = False
    row_of = np.empty(len(parent), np.int64)
    row_of[chains.node[own]] = np.flatnonzero(own)
    sprout = chains.sprout[alive]
    fork = parent[sprout]
    while True:
        lost = (fork >= 0) & ~alive[chains.chain[row_of[np.maximum(fork, 0)]]]
        if not lost.any():
            break
        fork = np.where(lost, parent[chains.sprout[chains.chain[row_of[np.maximum(fork, 0)]]]], fork)
    row = np.where(fork >= 0, kept_row[row_of[np.maximum(fork, 0)]], 0)
    number = np.cumsum(alive) - 1
    host = np.where(fork >= 0, number[chains.chain[row_of[np.maximum(fork, 0)]]], 0)
    # A trunk of no length leaves branches without a host: the first of them takes its place.
    host[0], row[0] = -1, 0
    return host, row


def any_across(along: Floats) -> Floats:
    """Some unit vector across each unit vector (n, 3)."""
    flat = np.eye(3)[np.argmin(np.abs(along), axis=1)]
    return unit(flat - np.sum(flat * along, axis=1, keepdims=True) * along)
