"""A painted edit changes the branches where it was painted, and no others (Particle Flows, sections 1, 9)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from flowtree.branches.order_branches import order_branches
from flowtree.branches.smooth_branches import smooth_branches
from flowtree.geometry.find_painted import PaintedPlaces, find_painted
from flowtree.geometry.parent_array import child_count, levels, parents_first, reach_to_tip, sum_to_root
from flowtree.model.camera import Camera
from flowtree.model.edit import PaintedEdit
from flowtree.model.skeleton import Skeleton

_REACH = 0.025  # of the height: as near as this to a branch that is there a new one joins it
_BEARS = 3.0  # times its own particles, what a branch can take over
_HEADING = 0.6  # cosine with the branch that a new one should leave it at
_SMALLEST = 0.03  # of the height: what was cut off and is shorter goes, too
_ROUNDS = 6  # of smoothing of new ways

_Bools = NDArray[np.bool_]


@dataclass(frozen=True)
class Patch:
    """A skeleton made of two.

    Attributes:
        skeleton: of both.
        plain: (n,) number in the skeleton that there was, -1 for what is new.
        painted: (n,) number in the skeleton with the paint, -1 for what was there.
    """

    skeleton: Skeleton
    plain: NDArray[np.int64]
    painted: NDArray[np.int64]


def patch_skeleton(
    plain: Skeleton,
    painted: Skeleton,
    cameras: Sequence[Camera],
    edits: Sequence[PaintedEdit],
    *,
    height: float,
) -> Patch:
    """Takes from the tree of the painted views what lies where they are painted, the rest from the other.

    Particles meet by chance: whatever is changed anywhere, half of all branches would run otherwise. So the
    tree without the paint stays, except for what lies in the paint. What was erased or given another
    direction is cut out, and so is what ended where something was added. From the painted tree come the
    branches that end there, each down to the first branch that is still there and can bear it. What was
    borne by a cut branch, but lies outside, stays where it is and is borne along the painted tree's nearest
    way.

    Args:
        plain: with radii and twigs, made without the paint.
        painted: the same made with it.
        cameras: of the views.
        edits: one a view.
        height: of the tree [m].

    Returns: the skeleton; away from the paint, and from the new ways to the foot, all nodes are the plain
        one's. What bears more or less than before is as much thicker or thinner as Da Vinci's rule says.
    """
    patching = _Patching(plain, painted, cameras, edits, height)
    patching.hang_pieces()
    patching.grow_painted()
    return patching.finish()


def _own(skeleton: Skeleton) -> NDArray[np.int64]:
    """Particles (n,) that set off at each node; twigs have none."""
    flowed = np.where(skeleton.twig, 0, skeleton.particles).astype(np.int64)
    own = flowed.copy()
    np.subtract.at(own, skeleton.parent[1:], flowed[1:])
    return np.maximum(own, 0)


def _cut(plain: Skeleton, places: PaintedPlaces) -> _Bools:
    """Nodes (n,) of the plain skeleton that go."""
    behind = sum_to_root(plain.parent, (~places.added).astype(np.int64))
    cut = places.taken | (behind == 0)
    cut[0] = False
    return np.asarray(cut)


class _Patching:
    """Both skeletons' nodes in one numbering, the plain one's first, while they become one tree."""

    def __init__(
        self,
        plain: Skeleton,
        painted: Skeleton,
        cameras: Sequence[Camera],
        edits: Sequence[PaintedEdit],
        height: float,
    ) -> None:
        self._plain, self._painted, self._height = plain, painted, height
        self._first = len(plain.parent)
        both = (plain, painted)
        self._points = np.concatenate([one.points for one in both]).astype(np.float64)
        self._own = np.concatenate([_own(one) for one in both])
        self._parent = np.concatenate([plain.parent, painted.parent]).astype(np.int64)
        self._parent[self._first :] += self._first
        self._look_up = partial(find_painted, cameras=cameras, edits=edits)
        places = self._look_up(plain.points)
        self._inside = np.concatenate([places.anyhow, self._look_up(painted.points).anyhow])
        self._kept = ~_cut(plain, places)
        self._piece = self._label_pieces()
        # The root of the painted tree is the plain one's.
        self._above = np.where(self._kept, plain.parent, -1).astype(np.int64)
        self._above = np.concatenate([self._above, np.full(len(painted.parent), -1)])
        self._on = np.zeros(len(self._points), np.bool_)
        self._on[: self._first] = self._piece == 0
        self._bearers = np.flatnonzero(self._kept & ~plain.twig)
        self._near = cKDTree(plain.points[self._bearers])

    def _label_pieces(self) -> NDArray[np.int64]:
        """The first node of the connected piece that each kept node belongs to; -1 for cut ones."""
        piece = np.where(self._kept, np.arange(self._first), -1)
        for nodes in levels(self._plain.parent)[1:]:
            above = self._plain.parent[nodes]
            piece[nodes] = np.where(self._kept[nodes], np.where(self._kept[above], piece[above], nodes), -1)
        return piece

    def hang_pieces(self) -> None:
        """What was cut off the tree and lies outside gets a way to the foot."""
        roots = np.flatnonzero((self._piece == np.arange(self._first)) & (self._piece > 0))
        far = reach_to_tip(self._plain.parent, self._plain.points)[roots] >= _SMALLEST * self._height
        roots = roots[far & ~self._plain.twig[roots]]
        carriers = np.flatnonzero(~self._painted.twig)[1:]
        if not len(roots) or not len(carriers):
            return
        nearest = carriers[cKDTree(self._painted.points[carriers]).query(self._plain.points[roots])[1]]
        for k in np.argsort(-self._plain.particles[roots], kind="stable").tolist():
            root = int(roots[k])
            load = int(self._plain.particles[root])
            host = self._find_host(self._points[root], load)
            if host < 0:
                host = self._first + int(nearest[k])
                self._lead_down(host, np.full(len(self._painted.parent), load))
            self._above[root] = host
            self._on[: self._first] |= self._piece == root

    def grow_painted(self) -> None:
        """What the painted tree has in the paint grows from the branches that are there."""
        painted, first = self._painted, self._first
        inside = self._inside[first:]
        tips = (child_count(painted.parent) == 0) & inside
        tips[0] = False
        ends = tips | ((self._own[first:] > 0) & inside)
        load = sum_to_root(painted.parent, np.where(ends, np.maximum(self._own[first:], 1), 0))
        self._own[first:] = np.where(inside, self._own[first:], 0)
        for tip in np.flatnonzero(tips).tolist():
            self._lead_down(first + tip, load)

    def _find_host(self, place: NDArray[np.float64], load: int) -> int:
        """A branch that is there, near, strong enough and not against its direction; -1 for none."""
        reach = _REACH * self._height
        near = self._bearers[self._near.query_ball_point(place, reach)]
        near = near[self._on[near] & (self._plain.particles[near] * _BEARS >= load)]
        if not len(near):
            return -1
        way = place - self._points[near]
        length = np.linalg.norm(way, axis=1)
        onward = self._points[near] - self._points[np.maximum(self._parent[near], 0)]
        size = np.maximum(length * np.linalg.norm(onward, axis=1), 1e-12)
        short = np.maximum(_HEADING - np.einsum("ij,ij->i", way, onward) / size, 0.0)
        return int(near[np.argmin(length / reach + short)])

    def _lead_down(self, node: int, load: NDArray[np.int64]) -> None:
        """Takes a node of the painted tree and all on its way to the first branch that can bear it."""
        while not self._on[node]:
            self._on[node] = True
            below = int(self._parent[node])
            host = (
                0
                if below == self._first
                else self._find_host(self._points[below], int(load[below - self._first]))
            )
            self._above[node] = below if host < 0 else host
            node = self._above[node]

    def finish(self) -> Patch:
        """The skeleton of what is connected, without limbs that have nothing left to bear."""
        self._drop_empty()
        used = np.flatnonzero(self._on)
        index = np.full(len(self._on), -1)
        index[used] = np.arange(len(used))
        above = self._above[used]
        order, parent = parents_first(np.where(above >= 0, index[np.maximum(above, 0)], -1))
        used = used[order]
        new = used >= self._first
        twig = np.concatenate([self._plain.twig, self._painted.twig])[used]
        before = np.concatenate([self._plain.particles, self._painted.particles])[used]
        total = np.where(twig, 1, np.maximum(sum_to_root(parent, self._own[used]), 1)).astype(np.int32)
        radius = np.concatenate([self._plain.radius, self._painted.radius])[used].astype(np.float64)
        radius *= np.sqrt(total / np.maximum(before, 1))
        for nodes in levels(parent)[1:]:
            radius[nodes] = np.minimum(radius[nodes], radius[parent[nodes]])
        way = new & ~self._inside[used] & ~twig
        points = self._points[used]
        smooth = smooth_branches(parent, points, total, rounds=_ROUNDS, still=~way)
        way &= ~self._look_up(smooth).anyhow
        points[way] = smooth[way]
        radii = radius.astype(np.float32)
        skeleton = Skeleton(
            parent=parent,
            points=points.astype(np.float32),
            radius=radii,
            particles=total,
            level=order_branches(parent, radii),
            twig=twig,
        )
        return Patch(skeleton, np.where(new, -1, used), np.where(new, used - self._first, -1))

    def _drop_empty(self) -> None:
        """Takes away what bears neither particles nor twigs any more."""
        order, parent = parents_first(self._above)
        twig = np.concatenate([self._plain.twig, self._painted.twig])
        bears = np.where(self._on, self._own + twig, 0)[order]
        self._on[order] &= sum_to_root(parent, bears) > 0
        self._on[0] = True
