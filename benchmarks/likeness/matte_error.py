"""How far a matte is from the true one."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

_SEEN = 0.05  # alpha from which on a pixel belongs to the tree's box


def matte_error(alpha: NDArray[np.float32], truth: NDArray[np.float32]) -> float:
    """Mean absolute error over the true tree's box: 0 equal, 1 all wrong.

    Args:
        alpha: (h, w) in 0..1.
        truth: (h, w) in 0..1.
    """
    rows, columns = (np.flatnonzero((truth > _SEEN).any(axis=axis)) for axis in (1, 0))
    box = slice(int(rows[0]), int(rows[-1]) + 1), slice(int(columns[0]), int(columns[-1]) + 1)
    return float(np.abs(alpha[box] - truth[box]).mean())
