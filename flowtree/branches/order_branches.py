"""Branching order."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from flowtree.geometry.parent_array import levels, main_child


def order_branches(parent: NDArray[np.int32], weight: NDArray[Any]) -> NDArray[np.int32]:
    """How many forks lie between a node and the trunk at which its way leaves the thicker branch.

    Args:
        parent: (n,).
        weight: (n,) what decides which child carries its parent's branch on: particles or radius.

    Returns: (n,) int32, 0 on the trunk.
    """
    carries_on = main_child(parent, weight)
    order = np.zeros(len(parent), np.int32)
    for nodes in levels(parent)[1:]:
        above = parent[nodes]
        order[nodes] = order[above] + (carries_on[above] != nodes)
    return order
