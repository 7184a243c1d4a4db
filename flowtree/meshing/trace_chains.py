"""Splits a skeleton into branches, each an unbroken run of nodes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flowtree.model.skeleton import Skeleton


@dataclass(frozen=True)
class Chains:
    """Branches one behind the other; a side branch begins with a copy of the node it leaves.

    Attributes:
        node: (k,) int64, the skeleton node of every entry, from the branch's base to its tip.
        chain: (k,) int64, which branch an entry belongs to, never falling; 0 is the trunk.
        sprout: (c,) int64, the first node that is the branch's own (the root for the trunk).
    """

    node: NDArray[np.int64]
    chain: NDArray[np.int64]
    sprout: NDArray[np.int64]


def trace_chains(skeleton: Skeleton) -> Chains:
    """Follows every branch from its base to its tip.

    At a fork the branch continues into the thickest child; children of equal radius are told apart by their
    particles, then by how straight they go on, then by their index. Every other child begins a branch.

    Returns: at least one chain; each has two entries or more, unless the skeleton is a single node.
    """
    parent = skeleton.parent.astype(np.int64)
    n = len(parent)
    head = _heads(skeleton, parent)
    # Pointer doubling: both arrays reach the head of the branch in log2(longest branch) rounds.
    jump = np.where(head, np.arange(n), parent)
    steps = np.where(head, 0, 1)
    while True:
        further = jump[jump]
        if np.array_equal(further, jump):
            break
        steps = steps + steps[jump]
        jump = further
    sprout = np.flatnonzero(head)
    order = np.lexsort((steps, jump))
    chain = np.searchsorted(sprout, jump[order])
    first = np.searchsorted(chain, np.arange(1, len(sprout)))
    return Chains(
        node=np.insert(order, first, parent[sprout[1:]]),
        chain=np.insert(chain, first, np.arange(1, len(sprout))),
        sprout=sprout,
    )


def _heads(skeleton: Skeleton, parent: NDArray[np.int64]) -> NDArray[np.bool_]:
    """(n,) bool: whether a branch begins at the node, rather than continuing its parent's."""
    points = skeleton.points.astype(np.float64)
    reach = points - points[np.maximum(parent, 0)]
    length = np.linalg.norm(reach, axis=1, keepdims=True)
    direction = np.divide(reach, length, out=np.zeros_like(reach), where=length > 0)
    straight = np.sum(direction * direction[np.maximum(parent, 0)], axis=1)
    index = np.arange(len(parent))
    rank = np.lexsort((-index, straight, skeleton.particles, skeleton.radius, parent))
    head = np.ones(len(parent), np.bool_)
    last_of_parent = np.flatnonzero(np.diff(parent[rank], append=-2) != 0)
    head[rank[last_of_parent]] = False
    head[0] = True
    return head
