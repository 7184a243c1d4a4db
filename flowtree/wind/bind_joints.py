"""Joints for the skeleton of an animated tree."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flowtree import check
from flowtree.geometry.parent_array import levels, main_child
from flowtree.model.skeleton import Skeleton
from flowtree.model.wind import Armature

_SPACING = 0.12  # of the joints along a branch, relative to the longest way from foot to tip
_MOST_ON_A_BRANCH = 6


@dataclass
class _Joints:
    """Joints while they are added."""

    parent: list[int]
    points: list[NDArray[np.float32]]
    node: list[int]


def bind_joints(skeleton: Skeleton, *, joints: int = 160) -> Armature:
    """Puts joints on the stem and on as many branches as they suffice for, the thick and long ones first.

    A branch that bends begins with a joint where it leaves its parent branch, and has more along a longer
    course; between two joints its nodes go over smoothly from one to the next. A branch without joints
    follows the place where it leaves as one stiff piece, so that nothing tears. Joint 0 stands at the foot
    and carries the whole tree.

    Args:
        skeleton: world frame [m].
        joints: at most so many.

    Returns: see `Armature`.

    Raises:
        InputError: fewer than one joint.
    """
    check.require(joints >= 1, "wind joints", "must be at least 1", joints, "ask for more")
    parent = skeleton.parent.astype(np.int64)
    points = skeleton.points.astype(np.float64)
    length = np.linalg.norm(points - points[np.maximum(parent, 0)], axis=1)
    length[0] = 0.0
    rank = levels(parent)
    onward = main_child(parent, skeleton.radius)
    chosen, whole = _choose_branches(skeleton, rank, onward, length, joints)

    count = len(parent)
    joint = np.full((count, 2), -1, np.int64)
    weight = np.zeros((count, 2))
    made = _Joints([], [], [])
    for nodes, along in chosen:
        # Thicker branches come first in `chosen`, and every branch after the one that it leaves.
        carrier = -1 if nodes[0] == 0 else int(joint[parent[nodes[0]], 0])
        begin = _spread(along, length[nodes], whole)
        numbers = len(made.node) + np.arange(len(begin))
        made.parent += [carrier, *numbers[:-1].tolist()]
        made.node += nodes[begin].tolist()
        made.points += list(skeleton.points[np.maximum(parent[nodes[begin]], 0)])
        joint[nodes], weight[nodes] = _blend(along, along[begin] - length[nodes[begin]], numbers, carrier)
    for nodes in rank[1:]:
        free = nodes[joint[nodes, 0] < 0]
        joint[free], weight[free] = joint[parent[free]], weight[parent[free]]
    weight32 = weight.astype(np.float32)
    weight32[:, 1] = 1 - weight32[:, 0]
    return Armature(
        parent=np.array(made.parent, np.int32),
        points=np.array(made.points, np.float32),
        node=np.array(made.node, np.int32),
        joint=np.where(weight32 > 0, joint, 0).astype(np.int32),
        weight=weight32,
    )


def _choose_branches(
    skeleton: Skeleton,
    rank: list[NDArray[np.int64]],
    onward: NDArray[np.int64],
    length: NDArray[np.float64],
    joints: int,
) -> tuple[list[tuple[NDArray[np.int64], NDArray[np.float64]]], float]:
    """The branches that get joints, and the longest way from the foot to a tip [m].

    Of each branch: its nodes, and how far along the branch they lie [m].
    """
    parent = skeleton.parent
    reach = length.copy()  # from the segment's beginning to the farthest tip beyond
    thickness = skeleton.radius.astype(np.float64)
    for nodes in reversed(rank[1:]):
        np.maximum.at(reach, parent[nodes], length[parent[nodes]] + reach[nodes])
    for nodes in rank[1:]:
        thickness[nodes] = np.minimum(thickness[nodes], thickness[parent[nodes]])
    heads = np.flatnonzero(onward[np.maximum(parent, 0)] != np.arange(len(parent)))
    # Never more than at the branch before: both factors fall toward the tips.
    order = heads[np.lexsort((heads, -(reach * thickness)[heads]))]
    chosen: list[tuple[NDArray[np.int64], NDArray[np.float64]]] = []
    left = joints
    for head in order:
        run = [int(head)]
        while (following := int(onward[run[-1]])) >= 0:
            run.append(following)
        branch = np.array(run)
        along = np.cumsum(length[branch])
        left -= len(_spread(along, length[branch], reach[0]))
        if left < 0 and chosen:
            break
        chosen.append((branch, along))
    return chosen, float(reach[0])


def _spread(along: NDArray[np.float64], length: NDArray[np.float64], whole: float) -> NDArray[np.int64]:
    """Which of a branch's nodes begin a joint, its first among them: evenly spread."""
    wanted = 1 + min(_MOST_ON_A_BRANCH - 1, int(along[-1] / (_SPACING * whole)) if whole > 0 else 0)
    place = np.arange(wanted) * along[-1] / wanted
    first = np.searchsorted(along - length, place[1:])
    return np.unique(np.append(0, first[first < len(along)]))


def _blend(
    along: NDArray[np.float64], place: NDArray[np.float64], numbers: NDArray[np.int64], carrier: int
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """The joints and weights of a branch's nodes, the heavier one first.

    Args:
        along: (m,) [m], where the nodes lie.
        place: (k,) [m], where the joints stand, the first at 0.
        numbers: (k,) of the joints.
        carrier: the joint that carries the branch; -1 for none.
    """
    gap = np.diff(np.append(place, along[-1]))
    half = 0.5 * np.minimum(gap, np.append(gap[0], gap[:-1]))
    own = np.searchsorted(place, along, side="right") - 1
    following = np.minimum(own + 1, len(place) - 1)
    past, ahead = along - place[own], place[following] - along
    begins = (past < half[own]) & ((own > 0) | (carrier >= 0))
    ends = (following > own) & (ahead < half[following])
    before = np.where(own > 0, numbers[np.maximum(own - 1, 0)], carrier)
    other = np.where(begins, before, np.where(ends, numbers[following], numbers[own]))
    # At a joint both count alike; at its carrier's end a branch begins with its carrier alone.
    reached = np.divide(past, half[own], out=np.ones(len(past)), where=half[own] > 0)
    share = np.where(ends, 0.5 + 0.5 * ahead / np.maximum(half[following], 1e-30), 1.0)
    share = np.where(begins, np.where(own > 0, 0.5 + 0.5 * reached, reached), share)
    share = share * share * (3.0 - 2.0 * share)
    share[other == numbers[own]] = 1.0
    swap = share < 0.5
    pair = np.stack([np.where(swap, other, numbers[own]), np.where(swap, numbers[own], other)], axis=1)
    heavier = np.where(swap, 1.0 - share, share)
    return pair, np.stack([heavier, 1.0 - heavier], axis=1)
