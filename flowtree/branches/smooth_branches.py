"""Smooth instead of chiselled branches (Particle Flows, figure 5c)."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from flowtree.geometry.parent_array import main_child


def smooth_branches(
    parent: NDArray[np.int32],
    points: NDArray[np.float64],
    weight: NDArray[Any],
    *,
    rounds: int,
    still: NDArray[np.bool_] | None = None,
) -> NDArray[np.float64]:
    """Moves every node toward the middle of its neighbours along its branch; the root and the tips stay.

    A branch goes on into its heaviest child, so the limb runs smoothly through a fork and the side branch
    bends away from it.

    Args:
        parent: (n,).
        points: (n, 3) [m].
        weight: (n,) decides which child carries a branch on.
        rounds: of smoothing, each by half the way.
        still: (n,) nodes that stay besides; None for no other.

    Returns: (n, 3) [m].
    """
    ahead = main_child(parent, weight)
    moves = (parent >= 0) & (ahead >= 0)
    inner = np.flatnonzero(moves if still is None else moves & ~still)
    smooth = points.copy()
    for _ in range(rounds):
        middle = (smooth[parent[inner]] + smooth[ahead[inner]]) / 2
        smooth[inner] += (middle - smooth[inner]) / 2
    return smooth
