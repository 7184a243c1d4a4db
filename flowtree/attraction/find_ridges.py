"""Bright and dark lines of a picture."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

# Standard deviations at which a kernel ends. A kernel no wider than a cell falls off slowly as it is sampled.
_REACH, _REACH_NARROW = 8, 100


def find_ridges(
    values: NDArray[np.float32], sigmas: Sequence[float]
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Sato's filter for lines (Sato 1998), for bright and for dark ones at once, the strongest of all scales.

    A line answers with the curvature across it: where it is bright, ``-sigma**2`` times the lower eigenvalue
    of the Hessian, where it is dark, ``sigma**2`` times the upper one. The Hessian is scikit-image's, made of
    two first derivatives of a Gaussian each, and the answers are bit by bit those of its ``sato``. That asks
    for each sign alone, and loads all of ``scipy.stats`` to do so.

    Args:
        values: (h, w); beyond the picture its edge goes on.
        sigmas: half widths of the lines [cells].

    Returns: bright (h, w) and dark (h, w), >= 0.
    """
    bright, dark = np.zeros_like(values), np.zeros_like(values)
    for sigma in sigmas:
        upper, lower = _curvatures(values, sigma)
        bright = np.maximum(bright, sigma**2 * np.maximum(-lower, 0))
        dark = np.maximum(dark, sigma**2 * np.maximum(upper, 0))
    return bright, dark


def _curvatures(values: NDArray[np.float32], sigma: float) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """The larger and the smaller eigenvalue (h, w) of the Hessian at this scale."""
    reach = _REACH if sigma > 1.0 else _REACH_NARROW

    def derive(picture: NDArray[np.float32], order: tuple[int, int]) -> NDArray[np.float32]:
        # Two derivatives follow each other: each smooths with half the variance.
        half = sigma / np.sqrt(2.0)
        return np.asarray(ndimage.gaussian_filter(picture, half, order, mode="nearest", truncate=reach))

    down, right = derive(values, (1, 0)), derive(values, (0, 1))
    rows, mixed, columns = derive(down, (1, 0)), derive(down, (0, 1)), derive(right, (0, 1))
    mean = (rows + columns) / 2
    apart = np.sqrt(mixed**2 + ((rows - columns) / 2) ** 2)
    return np.asarray(mean + apart, np.float32), np.asarray(mean - apart, np.float32)
