"""Natural angles at forks that the flow made too steep (Particle Flows, sections 8 and 9.1)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flowtree.branches.order_branches import order_branches
from flowtree.geometry.parent_array import main_child, parents_first, sum_to_root

_LONGEST = 14  # nodes that two branches may run side by side before they are left as they are


def relax_forks(
    parent: NDArray[np.int32],
    points: NDArray[np.float64],
    own: NDArray[np.int32],
    still: NDArray[np.bool_],
    *,
    least_angle: float,
) -> tuple[NDArray[np.int32], NDArray[np.float64], NDArray[np.int32], NDArray[np.bool_]]:
    """Moves the forks of side branches that first run along their limb to where the two part.

    Particles attract each other before they join, so a side branch approaches its limb at a small angle. Such
    a branch is followed outwards, together with its limb, until the way over from the limb makes at least
    ``least_angle`` with it; there it is attached, and the nodes before are dropped. Whatever grew from those
    nodes grows from the limb beside them, and is looked at in turn.

    In the end every side branch leaves at ``least_angle`` or more, but for those that end, or run on for more
    than ``_LONGEST`` nodes, before they part from their limb.

    Args:
        parent: (n,), parents before children.
        points: (n, 3) [m].
        own: (n,) particles that set off at each node.
        still: (n,) nodes of limbs that the pictures show: their forks stay where they are.
        least_angle: between the limb and a side branch [degrees].

    Returns: parent, points, own and still of what is left, parents before children.
    """
    parent = parent.astype(np.int32)
    own = own.copy()
    least_cosine = float(np.cos(np.radians(least_angle)))
    gone = np.zeros(len(parent), np.bool_)
    level = 1
    while True:
        particles = sum_to_root(parent, own)
        ahead = main_child(parent, particles)
        order = order_branches(parent, particles)
        sides = (order == level) & (parent >= 0)
        if not sides.any():
            break
        starts = np.flatnonzero(sides & ~still & (order[np.maximum(parent, 0)] < level))
        found = _partings(parent, points, ahead, starts, least_cosine)
        by_parent = np.argsort(parent, kind="stable")
        bounds = np.searchsorted(parent[by_parent], np.arange(len(parent) + 1))
        for path, limb in found:
            children = [by_parent[bounds[node] : bounds[node + 1]] for node in path[:-1]]
            _attach_at(parent, own, gone, path, limb, np.concatenate(children))
        # What grew from the dropped nodes is of this order now, and a moved branch may outweigh what is left
        # of its limb and carry it on: the limb is looked at again. Every move drops a node, so this ends.
        level = max(level - 1, 1) if found else level + 1
    kept = ~gone
    index = np.cumsum(kept) - 1
    above = parent[kept]
    place, sorted_parent = parents_first(np.where(above >= 0, index[above], -1))
    return sorted_parent, points[kept][place], own[kept][place], still[kept][place]


def _partings(
    parent: NDArray[np.int32],
    points: NDArray[np.float64],
    ahead: NDArray[np.int64],
    starts: NDArray[np.int64],
    least_cosine: float,
) -> list[tuple[list[int], list[int]]]:
    """Side branches to move: their nodes up to the one that parts, and the limb's nodes beside them."""
    side, fork = starts.copy(), parent[starts].astype(np.int64)
    limb = fork.copy()
    sides, limbs = [side], [limb]
    open_ = np.ones(len(starts), np.bool_)
    parted = np.full(len(starts), -1)
    for k in range(_LONGEST):
        beyond = ahead[limb]
        along = points[np.maximum(beyond, 0)] - points[limb]
        over = points[side] - points[limb]
        length = np.linalg.norm(along, axis=1) * np.linalg.norm(over, axis=1)
        wide = np.sum(along * over, axis=1) < least_cosine * length
        now = open_ & (wide | (beyond < 0))  # where the limb has ended the branch carries it on
        parted[now] = k
        open_ &= ~now & (ahead[side] >= 0)
        side = np.where(open_, ahead[side], side)
        limb = np.where(open_, beyond, limb)
        sides.append(side)
        limbs.append(limb)
    moved = np.flatnonzero(parted > 0)
    return [
        ([int(s[i]) for s in sides[: parted[i] + 1]], [int(m[i]) for m in limbs[: parted[i] + 1]])
        for i in moved
    ]


def _attach_at(
    parent: NDArray[np.int32],
    own: NDArray[np.int32],
    gone: NDArray[np.bool_],
    path: list[int],
    limb: list[int],
    children: NDArray[np.int64],
) -> None:
    """Attaches the last node of a path to the limb, and drops those before it, whose children are given."""
    beside = dict(zip(path[:-1], limb[1:], strict=True))
    for child in children.tolist():
        if child not in beside and child != path[-1]:
            parent[child] = beside[int(parent[child])]
    parent[path[-1]] = limb[-1]
    for node, heir in beside.items():
        own[heir] += own[node]
        own[node] = 0
        gone[node] = True
        parent[node] = -1
