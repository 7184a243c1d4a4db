"""Whether a surface in a file has no hole."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray


def is_closed(positions: NDArray[Any], triangles: NDArray[np.integer[Any]]) -> bool:
    """Whether every edge is passed as often in one direction as in the other, as in closed surfaces.

    Vertices at one place count as one: texture seams have split them. Closed pieces may touch or coincide.

    Args:
        positions: (n, 3).
        triangles: (m, 3); none is not closed.
    """
    _, place = np.unique(positions, axis=0, return_inverse=True)
    corners = place.reshape(-1)[triangles].astype(np.int64)
    a, b, c = corners.T
    corners = corners[(a != b) & (b != c) & (c != a)]
    start, end = corners.ravel(), np.roll(corners, -1, axis=1).ravel()
    base = len(positions)
    return len(corners) > 0 and np.array_equal(np.sort(start * base + end), np.sort(end * base + start))
