"""Bright and dark lines of a picture."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

_REACH = 8  # standard deviations at which a kernel ends: what lies beyond is lost in rounding


def find_ridges(
    values: NDArray[np.float32], sigmas: Sequence[float]
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Sato's filter for lines (Sato 1998), for bright and for dark ones at once, the strongest of all scales.

    A line answers with the curvature across it: where it is bright, ``-sigma**2`` times the lower eigenvalue
    of the Hessian, where it is dark, ``sigma**2`` times the upper one. The Hessian is scikit-image's, made of
    two first derivatives of a Gaussian each, and the answers are those of its ``sato`` but for rounding. That
    asks for each sign alone, loads all of ``scipy.stats`` to do so and takes four times as long.

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
    # Two derivatives follow each other: each smooths with half the variance.
    half = sigma / np.sqrt(2.0)
    reach = int(_REACH * half + 0.5)
    place = np.arange(-reach, reach + 1)
    smooth = np.exp(-0.5 * (place / half) ** 2)
    smooth /= smooth.sum()
    kernels = (smooth, place / half**2 * smooth)

    def derive(picture: NDArray[np.float32], order: tuple[int, int]) -> NDArray[np.float32]:
        down, right = (kernels[k] for k in order)
        made = cv2.sepFilter2D(picture, cv2.CV_32F, right, down, borderType=cv2.BORDER_REPLICATE)
        return np.asarray(made, np.float32)

    down, right = derive(values, (1, 0)), derive(values, (0, 1))
    rows, mixed, columns = derive(down, (1, 0)), derive(down, (0, 1)), derive(right, (0, 1))
    mean = (rows + columns) / 2
    apart = np.sqrt(mixed**2 + ((rows - columns) / 2) ** 2)
    return np.asarray(mean + apart, np.float32), np.asarray(mean - apart, np.float32)
