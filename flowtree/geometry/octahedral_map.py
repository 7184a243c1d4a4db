"""Directions of the upper half of the world on a square."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray


def square_to_direction(places: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
    """Unit vectors (n, 3), y >= 0, of places (n, 2) in -1..1 on the square.

    The hemi-octahedral map (Cigolle et al. 2014, section 3.2): the middle is straight up, the border is the
    horizon, its corners are +x, +z, -x and -z.
    """
    x = 0.5 * (places[:, 0] + places[:, 1])
    z = 0.5 * (places[:, 1] - places[:, 0])
    y = 1.0 - np.abs(x) - np.abs(z)
    vectors = np.stack([x, y, z], axis=1)
    return np.asarray(vectors / np.linalg.norm(vectors, axis=1, keepdims=True), np.float64)


def direction_to_square(vectors: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
    """The places (n, 2) of vectors (n, 3) of any length; those below the horizon lie on the border."""
    x, y, z = vectors.astype(np.float64).T
    total = np.abs(x) + np.maximum(y, 0.0) + np.abs(z)
    total = np.where(total > 0, total, 1.0)
    x, z = x / total, z / total
    return np.stack([x - z, x + z], axis=1)


def level_axes(toward: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
    """Axes (3, 3) of a view from a direction: image-right, which is level, image-up, and the direction.

    Straight from above image-right is +x.
    """
    out = np.asarray(toward, np.float64)
    right = np.array([out[2], 0.0, -out[0]])
    length = float(np.linalg.norm(right))
    right = right / length if length > 1e-9 else np.array([1.0, 0.0, 0.0])
    return np.stack([right, np.cross(out, right), out])
