"""A normal map from heights."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def relief_map(height: NDArray[np.float64]) -> NDArray[np.uint8]:
    """(s, s, 3) of a height (s, s) in tile widths, by central differences on the torus; +y is up (glTF)."""
    scale = 0.5 * len(height)
    right = scale * (np.roll(height, -1, axis=1) - np.roll(height, 1, axis=1))
    up = scale * (np.roll(height, 1, axis=0) - np.roll(height, -1, axis=0))
    normal = np.stack([-right, -up, np.ones_like(height)], axis=2)
    normal /= np.linalg.norm(normal, axis=2, keepdims=True)
    encoded: NDArray[np.uint8] = np.rint(127.5 * (normal + 1.0)).astype(np.uint8)
    return encoded
