"""The branching order of an attractor."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from flowtree.geometry.parent_array import levels, main_child


def branch_levels(parent: NDArray[np.int32], points: NDArray[Any]) -> NDArray[np.int64]:
    """How many forks lie between a node and the stem at which its way leaves the branch that carries on.

    A branch is carried on by the child with the greatest length above it.

    Args:
        parent: (n,), -1 at the root.
        points: (n, 2) or (n, 3).

    Returns: (n,) 0 on the stem.
    """
    walk = levels(parent)
    length = np.linalg.norm(points - points[np.maximum(parent, 0)], axis=1).astype(np.float64)
    above = length.copy()
    for nodes in reversed(walk[1:]):
        np.add.at(above, parent[nodes], above[nodes])
    on = main_child(parent, above)
    level = np.zeros(len(parent), np.int64)
    for nodes in walk[1:]:
        below = parent[nodes]
        level[nodes] = level[below] + (on[below] != nodes)
    return level
