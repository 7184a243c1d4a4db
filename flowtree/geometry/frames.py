"""Orthonormal frames and rotations."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Vectors = NDArray[np.floating[Any]]


def unit(vectors: Vectors) -> NDArray[np.float64]:
    """Vectors (n, 3) of length 1; those without a length stay zero."""
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.asarray(np.divide(vectors, length, out=np.zeros(vectors.shape), where=length > 1e-12))


def side_axes(axis: Vectors) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Two unit vectors across each unit axis (n, 3): the one nearest to up, and the one across both.

    Along a vertical axis up is across nothing, so there the first points to -x.
    """
    up = np.array([0.0, 1.0, 0.0])
    across = up - axis * axis[:, 1:2]
    vertical = np.linalg.norm(across, axis=1) < 1e-6
    across[vertical] = np.array([-1.0, 0.0, 0.0])
    first = unit(across - axis * np.sum(across * axis, axis=1, keepdims=True))
    return first, np.cross(axis, first)


def quaternions(x: Vectors, y: Vectors, z: Vectors) -> NDArray[np.float64]:
    """Unit quaternions (n, 4) as (x, y, z, w) that turn the world's axes to the given ones (n, 3)."""
    m = np.stack([x, y, z], axis=-1)
    trace = np.trace(m, axis1=1, axis2=2)
    # Of the four squares, of x, y, z and w, the largest is at least 1/4: dividing by its root is safe.
    diagonal = np.stack([m[:, 0, 0], m[:, 1, 1], m[:, 2, 2]], axis=1)
    squares = np.concatenate([1 + 2 * diagonal - trace[:, None], 1 + trace[:, None]], axis=1)
    products = np.empty((len(m), 4, 4))
    pairs = {
        (0, 1): m[:, 0, 1] + m[:, 1, 0],
        (0, 2): m[:, 0, 2] + m[:, 2, 0],
        (1, 2): m[:, 1, 2] + m[:, 2, 1],
        (0, 3): m[:, 2, 1] - m[:, 1, 2],
        (1, 3): m[:, 0, 2] - m[:, 2, 0],
        (2, 3): m[:, 1, 0] - m[:, 0, 1],
    }
    for (i, j), value in pairs.items():
        products[:, i, j] = products[:, j, i] = value
    for i in range(4):
        products[:, i, i] = squares[:, i]
    best = np.argmax(squares, axis=1)
    raw = products[np.arange(len(m)), best]
    return np.asarray(raw / np.linalg.norm(raw, axis=1, keepdims=True))
