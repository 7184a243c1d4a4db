"""A guess of the tree behind what stands before it."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

_FIRST, _ENOUGH = 5, 0.1  # window of the first round [pixels]; share of it that must be known


def fill_occluded(alpha: NDArray[np.float32], occluded: NDArray[np.bool_]) -> NDArray[np.float32]:
    """Fills alpha from around: the mean of what is known in the smallest window that holds enough of it.

    Where no window up to twice the picture does, it is the mean of all that is known.

    Args:
        alpha: (h, w) in 0..1.
        occluded: (h, w), where something hides the tree.

    Returns: (h, w) in 0..1; unchanged where nothing hides it, and where everything does.
    """
    known = (~occluded).astype(np.float32)
    filled, missing, window = alpha.astype(np.float32), occluded.copy(), _FIRST
    if occluded.all():
        return filled
    while missing.any() and window < 2 * max(alpha.shape):
        size = (window, window)
        mass = cv2.blur(known, size, borderType=cv2.BORDER_REFLECT)
        sums = cv2.blur(alpha * known, size, borderType=cv2.BORDER_REFLECT)
        reached = missing & (mass > _ENOUGH)
        filled[reached] = np.clip(sums[reached] / mass[reached], 0.0, 1.0)
        missing &= ~reached
        window = 2 * window + 1
    filled[missing] = alpha[~occluded].mean()
    return filled
