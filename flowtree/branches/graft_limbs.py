"""Particles that have come to a limb go on along it (Particle Flows, sections 6 and 7)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from flowtree.geometry.parent_array import child_count, parents_first, sum_to_root
from flowtree.model.attractor import LimbTree

_FARTHEST = 2.5  # times the distance at which a path enters a limb: so far back toward the root it may enter

_Tree = tuple[NDArray[np.int32], NDArray[np.float64], NDArray[np.int32], NDArray[np.bool_]]


def graft_limbs(
    parent: NDArray[np.int32],
    points: NDArray[np.float64],
    own: NDArray[np.int32],
    limbs: LimbTree,
    *,
    reach: float,
    angle: float,
) -> _Tree:
    """Lets every path end where it comes to a limb, and the limb carry its particles to the foot.

    Close to the graph the field is the graph's tangent (equation 3 with h = 0): what a particle does there is
    known. But the particles of two limbs that leave the trunk at a small angle join long before the fork, for
    they come too near to each other; the paper names such steep forks as what it cannot do. So from where a
    path first comes within ``reach`` of a limb it is the limb's.

    Args:
        parent: (n,) of the joined paths, parents before children.
        points: (n, 3) [m].
        own: (n,) particles that set off at each node.
        limbs: what the pictures show.
        reach: distance at which a path belongs to a limb [m].
        angle: at which it should enter it [degrees].

    Returns:
        parent: (m,) parents before children.
        points: (m, 3) [m].
        own: (m,) of the same sum, and more than 0 at every tip.
        limb: (m,) bool, which nodes are the limbs'.
    """
    line = limbs.points.astype(np.float64)
    distance, nearest = cKDTree(line).query(points)
    taken = distance < reach
    taken[0] = True
    count = len(line)
    carried = np.bincount(nearest[taken], weights=own[taken], minlength=count).astype(np.int32)
    free = np.flatnonzero(~taken)
    place = np.full(len(parent), -1)
    place[free] = count + np.arange(len(free))
    enters = taken[parent[free]]
    above = place[parent[free]]
    entry = _enter(limbs, points[free[enters]], nearest[parent[free[enters]]], _FARTHEST * reach, angle)
    above[enters] = entry
    joined = np.concatenate([limbs.parent, above]).astype(np.int32)
    places = np.concatenate([line, points[free]])
    carried = _reach_tips(limbs, np.concatenate([carried, own[free]]), joined)
    kept = sum_to_root(joined, carried) > 0  # a path all of whose particles a limb has taken is none
    kept[0] = True
    index = np.cumsum(kept) - 1
    lower = joined[kept]
    order, sorted_parent = parents_first(np.where(lower >= 0, index[lower], -1))
    return (
        sorted_parent,
        places[kept][order],
        carried[kept][order],
        (np.arange(len(joined)) < count)[kept][order],
    )


def _enter(
    limbs: LimbTree, tips: NDArray[np.float64], node: NDArray[np.int64], far: float, angle: float
) -> NDArray[np.int64]:
    """The limb's node at which each path enters: the first toward the root that it meets at the angle."""
    line, parent = limbs.points.astype(np.float64), limbs.parent
    wanted = float(np.cos(np.radians(angle)))
    best, best_cosine = node.copy(), np.full(len(tips), -np.inf)
    node = node.copy()
    for _ in range(len(line)):
        way = tips - line[node]
        onward = line[node] - line[np.maximum(parent[node], 0)]
        length = np.linalg.norm(way, axis=1)
        size = length * np.linalg.norm(onward, axis=1)
        cosine = np.einsum("ij,ij->i", way, onward) / np.maximum(size, 1e-12)
        open_ = (best_cosine < wanted) & (parent[node] > 0) & (length < far)
        better = open_ & (cosine > best_cosine)
        best, best_cosine = np.where(better, node, best), np.where(better, cosine, best_cosine)
        if not open_.any():
            break
        node = np.where(open_, parent[node], node)
    return best


def _reach_tips(limbs: LimbTree, own: NDArray[np.int32], parent: NDArray[np.int32]) -> NDArray[np.int32]:
    """A limb that nobody has come to gets one particle from below, so that it is there."""
    own = own.copy()
    total = sum_to_root(parent, own)
    for tip in np.flatnonzero((child_count(limbs.parent) == 0) & (total[: len(limbs.parent)] == 0)).tolist():
        giver = tip
        while giver > 0 and own[giver] < 2:
            giver = int(limbs.parent[giver])
        if own[giver] < 2:  # nobody below can spare one: the limb with the most can
            giver = int(own.argmax())
        if own[giver] > 1:
            own[giver] -= 1
            own[tip] += 1
    return own
