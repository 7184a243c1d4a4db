"""Quaternions as matrices."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray


def rotation_matrices(rotation: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
    """Unit quaternions (n, 4) as (x, y, z, w) to matrices (n, 3, 3) whose columns are the turned axes."""
    x, y, z, w = rotation.astype(np.float64).T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)
