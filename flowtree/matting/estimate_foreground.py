"""The tree's own colour in every pixel, free of background."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

_REACHES = (0.09, 0.006)  # windows of the two passes, of the larger side


def estimate_foreground(rgb: NDArray[np.uint8], alpha: NDArray[np.float32]) -> NDArray[np.uint8]:
    """Foreground colours by blur fusion (Forte 2021, "Approximate fast foreground colour estimation").

    Twice, with a wide and a narrow window: F = blur(F alpha) / blur(alpha), the same for the background,
    then the rest of the pixel's equation I = alpha F + (1 - alpha) B is given to F in proportion to alpha.
    Where no tree is near, the colour is that of the nearest tree at a coarser scale.

    pymatting's multi-level method is as good, but its Numba code takes 5 s to compile in a new environment.

    Args:
        rgb: (h, w, 3).
        alpha: (h, w) in 0..1.

    Returns: (h, w, 3).
    """
    # Four channels throughout, the last one for the weight: colours and weight are blurred in one go, and
    # arrays of one shape are multiplied three times as fast as a picture by a weight that is spread over it.
    image = cv2.cvtColor(rgb, cv2.COLOR_RGB2RGBA).astype(np.float32) / np.float32(255.0)
    cover = cv2.merge([alpha.astype(np.float32)] * 4)
    rest = np.float32(1.0) - cover
    front, back = image, image
    for reach in _REACHES:
        front = _spread(front, cover, reach)
        back = _spread(back, rest, reach)
        # Written over itself: fresh memory costs more than the arithmetic on it.
        missing = cover * front
        np.subtract(image, missing, out=missing)
        missing -= rest * back
        missing *= cover
        front += missing
        np.clip(front, 0.0, 1.0, out=front)
    front *= np.float32(255.0)
    result: NDArray[np.uint8] = np.rint(front, out=front).astype(np.uint8)
    return np.ascontiguousarray(result[..., :3])


def _spread(colour: NDArray[Any], weight: NDArray[Any], reach: float) -> NDArray[Any]:
    """Weighted mean in a window, then in ones four times as wide where the weight ran out.

    Args:
        colour: (h, w, 4) float32; the last channel counts for nothing.
        weight: (h, w, 4) float32, the same in all channels.
        reach: of the first window, of the larger side.
    """
    size = max(colour.shape[:2])
    window = 2 * max(1, round(reach * size)) + 1
    sums = colour * weight
    sums[..., 3] = weight[..., 3]
    total: NDArray[Any] = cv2.blur(sums, (window, window), borderType=cv2.BORDER_REFLECT)
    share, wide = np.float32(1.0), np.empty_like(sums)
    while window <= size // 2:
        window, share = 4 * window + 1, share * np.float32(1e-3)
        cv2.blur(sums, (window, window), wide, borderType=cv2.BORDER_REFLECT)
        wide *= share
        total += wide
    mass = cv2.merge([cv2.extractChannel(total, 3)] * 4, wide)
    total /= np.maximum(mass, np.float32(1e-12), out=mass)
    return total
