"""A picture between the centres of its pixels."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float32]
Places = NDArray[np.floating[Any]]


def resample_picture(picture: Floats, down: Places, across: Places) -> Floats:
    """Bilinear interpolation at a grid of places; beyond the outer pixels' centres these go on.

    Args:
        picture: (h, w) or (h, w, k).
        down: (r,) rows to look at; 0 is the centre of the first.
        across: (c,) columns, likewise.

    Returns: (r, c) or (r, c, k).
    """
    for axis, place in enumerate((down, across)):
        low = np.clip(np.floor(place).astype(np.int64), 0, picture.shape[axis] - 1)
        high = np.minimum(low + 1, picture.shape[axis] - 1)
        share = np.clip(place - low, 0.0, 1.0).astype(np.float32)
        share = share.reshape([-1 if k == axis else 1 for k in range(picture.ndim)])
        picture = (1 - share) * np.take(picture, low, axis) + share * np.take(picture, high, axis)
    return np.asarray(picture, np.float32)
