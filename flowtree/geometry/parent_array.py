"""Rooted forests as parent arrays: depth, order, sums along the way to the root."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray


def depths(parent: NDArray[np.integer[Any]]) -> NDArray[np.int32]:
    """Edges between every node and its root, for parents in any order, by pointer doubling.

    Args:
        parent: (n,), -1 at roots.

    Returns: (n,) int32.

    Raises:
        ValueError: the parents run in a circle.
    """
    return sum_from_root(parent, (parent >= 0).astype(np.int32))


def sum_from_root(parent: NDArray[np.integer[Any]], own: NDArray[np.integer[Any]]) -> NDArray[np.int32]:
    """Every node's own whole number plus those of all nodes between it and its root, by pointer doubling.

    Args:
        parent: (n,), -1 at roots, in any order.
        own: (n,).

    Returns: (n,) int32.

    Raises:
        ValueError: the parents run in a circle.
    """
    jump = parent.astype(np.int64)
    total = own.astype(np.int64)
    going = np.flatnonzero(jump >= 0)
    for _ in range(len(parent).bit_length() + 1):
        if not len(going):
            return total.astype(np.int32)
        ahead = jump[going]
        total[going] += total[ahead]
        jump[going] = jump[ahead]
        going = going[jump[going] >= 0]
    raise ValueError("the parents run in a circle")


def parents_first(parent: NDArray[np.integer[Any]]) -> tuple[NDArray[np.int64], NDArray[np.int32]]:
    """An order in which every parent comes before its children, roots first; stable within a depth.

    Returns: ``order`` (n,), old index of each new node, and the parent array in the new order.
    """
    order = np.argsort(depths(parent), kind="stable")
    place = np.empty(len(parent), np.int64)
    place[order] = np.arange(len(parent))
    moved = parent[order]
    return order, np.where(moved >= 0, place[moved], -1).astype(np.int32)


def levels(parent: NDArray[np.integer[Any]]) -> list[NDArray[np.int64]]:
    """Node indices of every depth, the roots' first: what lets a tree be walked without a loop over nodes."""
    depth = depths(parent)
    order = np.argsort(depth, kind="stable")
    return np.split(order, np.flatnonzero(np.diff(depth[order])) + 1)


def sum_to_root(parent: NDArray[np.integer[Any]], own: NDArray[Any]) -> NDArray[Any]:
    """Every node's own value plus those of all nodes behind it: (n,)."""
    total = own.copy()
    for nodes in reversed(levels(parent)[1:]):
        np.add.at(total, parent[nodes], total[nodes])
    return total


def sum_before(parent: NDArray[np.integer[Any]], own: NDArray[Any]) -> NDArray[Any]:
    """The sum of the values of all nodes between every node and its root, without its own: (n,)."""
    total = np.zeros_like(own)
    for nodes in levels(parent)[1:]:
        total[nodes] = total[parent[nodes]] + own[parent[nodes]]
    return total


def child_count(parent: NDArray[np.integer[Any]]) -> NDArray[np.int64]:
    """Children of every node: (n,)."""
    return np.bincount(parent[parent >= 0], minlength=len(parent))


def main_child(parent: NDArray[np.integer[Any]], weight: NDArray[Any]) -> NDArray[np.int64]:
    """The child that carries each node's branch on: the heaviest, of equals the first; -1 at tips: (n,)."""
    nodes = np.flatnonzero(parent >= 0)
    # The heaviest, of equals the one with the lowest index, is written last.
    order = nodes[np.lexsort((-nodes, weight[nodes]))]
    heaviest = np.full(len(parent), -1, np.int64)
    heaviest[parent[order]] = order
    return heaviest


def reach_to_tip(parent: NDArray[np.integer[Any]], points: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
    """Way (n,) along the branches from each node (n, 3) to the farthest tip behind it, in their unit."""
    length = np.linalg.norm(points - points[np.maximum(parent, 0)], axis=1)
    reach = np.zeros(len(parent), np.float64)
    for nodes in reversed(levels(parent)[1:]):
        np.maximum.at(reach, parent[nodes], reach[nodes] + length[nodes])
    return reach
