"""From traces to branches (Particle Flows, sections 6 and 8)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from flowtree.branches.drop_rods import drop_rods
from flowtree.branches.graft_limbs import graft_limbs
from flowtree.branches.order_branches import order_branches
from flowtree.branches.prune_branches import prune_branches
from flowtree.branches.relax_forks import relax_forks
from flowtree.branches.smooth_branches import smooth_branches
from flowtree.geometry.parent_array import child_count, parents_first, sum_to_root
from flowtree.model.attractor import LimbTree
from flowtree.model.camera import Camera
from flowtree.model.edit import PaintedEdit
from flowtree.model.guessed_view import GuessedView
from flowtree.model.matte import Matte
from flowtree.model.skeleton import Skeleton
from flowtree.model.traces import FlowTraces
from flowtree.params import BranchParams


def build_skeleton(
    traces: FlowTraces,
    *,
    limbs: LimbTree | None = None,
    crown: Sequence[tuple[Matte, Camera]] = (),
    edits: Sequence[PaintedEdit] = (),
    between: Sequence[GuessedView] = (),
    params: BranchParams = BranchParams(),
) -> Skeleton:
    """Turns the particles' joined paths into branches with forks.

    The traces are thinned to one node every few steps; where they come to a limb that the pictures show they
    go on along it (`graft_limbs`), and the limb stays where it is; what ends inside the wood of the limb it
    leaves is pruned, and so is what crosses the gaps of a leafy crown (`drop_rods`); branches are smoothed
    (``params.smoothing``; 0 leaves them chiselled, Particle Flows, figure 5c); and where a path ran along its
    limb before it joined, the fork is moved to where the two part, at a natural angle.

    Args:
        traces: of the particles.
        limbs: that the pictures show; None for none.
        crown: each view's matte and camera of a leafy tree, whose gaps no thin branch crosses.
        edits: one a view, or none: what bears something painted may cross them.
        between: the volume from where no photograph looks: no thin branch leaves a
            leafy crown there.
        params: thinning, pruning, smoothing, angles.

    Returns: the skeleton, with ``radius`` still 0; the particles at the root are all particles.
    """
    parent, points, own = _thin(traces, params.stride)
    height = float(points[:, 1].max() - points[:, 1].min()) or 1.0
    limb = np.zeros(len(parent), np.bool_)
    if limbs is not None:
        parent, points, own, limb = graft_limbs(
            parent, points, own, limbs, reach=params.limb_reach * height, angle=params.entry_angle
        )
    parent, points, own, limb = prune_branches(
        parent,
        points,
        own,
        limb,
        shortest=params.shortest * height,
        limb_radius=params.limb_radius * height,
        longest_lone=params.longest_lone * height,
    )
    if crown:
        mattes, cameras = zip(*crown, strict=True)
        parent, points, own, limb = drop_rods(
            (parent, points, own, limb),
            mattes,
            cameras,
            height=height,
            longest=params.longest_gap * height,
            edits=edits,
            between=between,
        )
    points = smooth_branches(parent, points, sum_to_root(parent, own), rounds=params.smoothing, still=limb)
    parent, points, own, limb = relax_forks(parent, points, own, limb, least_angle=params.least_angle)
    points = smooth_branches(
        parent, points, sum_to_root(parent, own), rounds=params.smoothing // 2, still=limb
    )
    order, parent = parents_first(parent)
    points, particles = points[order], sum_to_root(parent, own[order])
    return Skeleton(
        parent=parent,
        points=points.astype(np.float32),
        radius=np.zeros(len(parent), np.float32),
        particles=particles.astype(np.int32),
        level=order_branches(parent, particles),
        twig=np.zeros(len(parent), np.bool_),
    )


def _thin(
    traces: FlowTraces, stride: int
) -> tuple[NDArray[np.int32], NDArray[np.float64], NDArray[np.int32]]:
    """Keeps the root, the tips and every ``stride``-th step; forks move down to the next node that stays.

    Returns: parents, points and each node's own particles (those that set off from there).
    """
    parent = traces.parent
    keep = (child_count(parent) == 0) | (traces.step % stride == 0)
    keep[0] = True
    kept_above = parent.astype(np.int64)
    while True:  # every round halves the way to the next kept node
        going = (kept_above >= 0) & ~keep[kept_above]
        if not going.any():
            break
        kept_above[going] = kept_above[kept_above[going]]
    index = np.cumsum(keep) - 1
    own = traces.particles.copy()
    np.subtract.at(own, parent[1:], traces.particles[1:])
    # A particle that set off in between starts lower.
    home = np.where(keep, np.arange(len(parent)), kept_above)
    total = np.bincount(index[home], weights=own, minlength=int(keep.sum()))
    above = kept_above[keep]
    return (
        np.where(above >= 0, index[above], -1).astype(np.int32),
        traces.points[keep].astype(np.float64),
        total.astype(np.int32),
    )
