"""Colours where a cut-out picture shows nothing, for filters that look there."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flowtree.render.resample_picture import resample_picture

Floats = NDArray[np.float32]


def dilate_colors(values: Floats, weight: Floats) -> Floats:
    """Fills the pixels of little weight from those around them (pull-push; Gortler et al. 1996, section 3.4).

    A texture is filtered, and halved for the distance, across the border of what it shows: colours that
    happen to lie outside would rim it.

    Args:
        values: (h, w, k), not multiplied with the weight.
        weight: (h, w) in 0..1; at 1 a pixel keeps its own value.

    Returns: (h, w, k); where there is no weight at all, the values as they are.
    """
    if not (weight > 0).any():
        return values
    return _fill(values, np.clip(weight, 0.0, 1.0)[:, :, None])


def _fill(values: Floats, weight: Floats) -> Floats:
    rows, columns = values.shape[:2]
    if rows == columns == 1:
        return values
    odd = [(0, rows % 2), (0, columns % 2), (0, 0)]
    heavy, total = np.pad(values * weight, odd), np.pad(weight, odd)
    heavy, total = (a[::2, ::2] + a[1::2, ::2] + a[::2, 1::2] + a[1::2, 1::2] for a in (heavy, total))
    mean = np.divide(heavy, total, out=np.zeros_like(heavy), where=total > 0)
    coarse = _fill(mean, np.minimum(total, np.float32(1)))
    behind = _double(coarse, rows, columns)
    return np.asarray(weight * values + (1 - weight) * behind, np.float32)


def _double(picture: Floats, rows: int, columns: int) -> Floats:
    """A picture of twice the size, between the centres of the pixels of this one."""
    down, across = ((np.arange(size) + 0.5) / 2.0 - 0.5 for size in (rows, columns))
    return resample_picture(picture, down, across)
