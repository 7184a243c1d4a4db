"""Branching order."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from flowtree.geometry.parent_array import main_child, sum_from_root


def order_branches(parent: NDArray[np.int32], weight: NDArray[Any]) -> NDArray[np.int32]:
    """How many forks lie between a node and the trunk at which its way leaves the thicker branch.

    Args:
        parent: (n,).
        weight: (n,) what decides which child carries its parent's branch on: particles or radius.

    Returns: (n,) int32, 0 on the trunk.
    """
    carries_on = main_child(parent, weight)
    leaves_it = (parent >= 0) & (carries_on[np.maximum(parent, 0)] != np.arange(len(parent)))
    return sum_from_root(parent, leaves_it)
