"""The smallest ball around points."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

_STEPS = 400
_OUTER = 4096  # points farthest from the box's middle, among which those lie that hold the ball


def smallest_ball(points: NDArray[np.float64]) -> tuple[NDArray[np.float64], float]:
    """Finds the ball by going ever smaller steps toward the farthest point (Badoiu and Clarkson 2003).

    Args:
        points: (3, n), n at least 1.

    Returns: its middle (3,) and its radius, which holds all points and is some thousandths too large at most.
    """
    middle = 0.5 * (points.min(axis=1) + points.max(axis=1))
    outer = points[:, np.argsort(-_squares(points, middle), kind="stable")[:_OUTER]]
    for step in range(_STEPS):
        far = int(np.argmax(_squares(outer, middle)))
        middle += (outer[:, far] - middle) / (step + 2)
    return middle, float(np.sqrt(_squares(points, middle).max()))


def _squares(points: NDArray[np.float64], middle: NDArray[np.float64]) -> NDArray[np.float64]:
    away = points - middle[:, None]
    squares: NDArray[np.float64] = (away * away).sum(axis=0)
    return squares
