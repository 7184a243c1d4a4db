"""A space-filling curve: points that follow each other on it lie near each other."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

_BITS = 10  # of each coordinate where points are ordered: a thousandth of their extent


def morton_code(cells: NDArray[np.integer[Any]]) -> NDArray[np.int64]:
    """The bits of three coordinates, interleaved.

    Args:
        cells: (n, 3), not negative and below 2**21.

    Returns: (n,) int64.
    """
    code = np.zeros(len(cells), np.int64)
    for bit in range(int(cells.max(initial=0)).bit_length()):
        for axis in range(3):
            code |= ((cells[:, axis].astype(np.int64) >> bit) & 1) << (3 * bit + axis)
    return code


def morton_order(points: NDArray[np.floating[Any]]) -> NDArray[np.int64]:
    """The order of points (n, 3) along the curve through their bounding box."""
    if not len(points):
        return np.zeros(0, np.int64)
    low = points.min(axis=0)
    edge = max(float((points.max(axis=0) - low).max()), 1e-12) / (2**_BITS - 1)
    return np.argsort(morton_code(((points - low) / edge).astype(np.int64)), kind="stable")
