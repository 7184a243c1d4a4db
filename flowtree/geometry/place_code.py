"""Whole numbers for places: what their random numbers hang on."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from flowtree.geometry.morton import morton_code

_PRECISE = 4096  # along the height: nearer points have one number
_HALF = 2**20  # the middle of what a Morton code can hold


def place_code(points: NDArray[np.floating[Any]], height: float) -> NDArray[np.int64]:
    """The Morton codes (n,) of the small cells, 1/4096 of the height, in which points (n, 3) [m] lie."""
    cell = np.floor(points.astype(np.float64) * (_PRECISE / height)).astype(np.int64) + _HALF
    return morton_code(np.clip(cell, 0, 2 * _HALF - 1))
