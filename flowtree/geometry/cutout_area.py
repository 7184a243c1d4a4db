"""How much of a surface its texture's alpha lets stand."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

_GRID = 48  # points along a triangle's side at which the alpha is looked up


def cutout_area(
    positions: NDArray[np.floating[Any]],
    uvs: NDArray[np.floating[Any]],
    triangles: NDArray[np.integer[Any]],
    alpha: NDArray[np.uint8],
    cutoff: float,
) -> float:
    """Area [m²], one side, of the triangles' points that pass the alpha test.

    The texture is looked up at a regular grid of points in every triangle; it repeats.

    Args:
        positions: (n, 3) [m].
        uvs: (n, 2), v grows downwards.
        triangles: (m, 3).
        alpha: (h, w).
        cutoff: 0..1, the least alpha that is seen.
    """
    a, b, c = (positions[triangles[:, k]].astype(np.float64) for k in range(3))
    area = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)
    step = (np.arange(_GRID) + 1.0 / 3.0) / _GRID
    u, v = (part.ravel() for part in np.meshgrid(step, step))
    below = u + v < 1.0
    weight = np.stack([1.0 - u - v, u, v])[:, below]
    uv = np.einsum("ks,tkd->tsd", weight, uvs[triangles].astype(np.float64))
    rows, columns = alpha.shape
    column = np.floor(uv[:, :, 0] * columns).astype(int) % columns
    row = np.floor(uv[:, :, 1] * rows).astype(int) % rows
    there = alpha[row, column] >= 255.0 * cutoff
    return float(np.sum(area * there.mean(axis=1)))
