"""Many small linear systems at once."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray


def solve_symmetric(matrix: NDArray[Any], right: NDArray[Any]) -> NDArray[Any]:
    """Solves a positive definite system of three unknowns for every pixel.

    Cholesky's root, written out over whole pictures: LAPACK, called once a system, takes three times as long.

    Args:
        matrix: (..., 3, 3), symmetric and positive definite; the lower triangle is read.
        right: (..., 3).

    Returns: (..., 3), x of matrix x = right, of the matrix's kind of numbers.
    """
    # One plane after the other in memory: strided reading costs more than all the arithmetic.
    a00, a10, a11, a20, a21, a22 = (
        np.ascontiguousarray(matrix[..., i, j]) for i in range(3) for j in range(i + 1)
    )
    b0, b1, b2 = (np.ascontiguousarray(right[..., i]) for i in range(3))
    root0 = 1.0 / np.sqrt(a00)
    low10, low20 = a10 * root0, a20 * root0
    root1 = 1.0 / np.sqrt(a11 - low10 * low10)
    low21 = (a21 - low20 * low10) * root1
    root2 = 1.0 / np.sqrt(a22 - low20 * low20 - low21 * low21)
    y0 = b0 * root0
    y1 = (b1 - low10 * y0) * root1
    y2 = (b2 - low20 * y0 - low21 * y1) * root2
    x2 = y2 * root2
    x1 = (y1 - low21 * x2) * root1
    x0 = (y0 - low10 * x1 - low20 * x2) * root0
    return np.stack([x0, x1, x2], axis=-1)
