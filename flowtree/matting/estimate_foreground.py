"""The tree's own colour in every pixel, free of background."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

_REACHES = (0.09, 0.006)  # windows of the two passes, of the larger side
_LESS = 1e-3  # what a window counts to the next narrower one
_FINE = 12  # pixels along a window that are enough for a mean over it
_LEAST = 8  # pixels along the side of the smallest picture that means are taken from


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
    windows = [2 * max(1, round(reach * size)) + 1]
    while windows[-1] <= size // 2:
        windows.append(4 * windows[-1] + 1)
    sums = colour * weight
    sums[..., 3] = weight[..., 3]
    total = _means(sums, [(window, _LESS**k) for k, window in enumerate(windows)])
    mass = cv2.merge([cv2.extractChannel(total, 3)] * 4)
    total /= np.maximum(mass, np.float32(1e-12), out=mass)
    return total


def _means(sums: NDArray[Any], windows: list[tuple[int, float]]) -> NDArray[Any]:
    """Sum of the means in ever wider windows, each times its share.

    From the second on, and where the first is wide already from that, they are taken from a smaller picture:
    it holds all that a mean over so many pixels shows.
    """
    height, width = sums.shape[:2]
    own = 1 if windows[0][0] < 2 * _FINE else 0
    total = _mean(sums, *windows[0]) if own else None
    if not windows[own:]:
        return np.asarray(total)
    factor = max(1, min(windows[own][0] // _FINE, height // _LEAST, width // _LEAST))
    small = cv2.resize(sums, (width // factor, height // factor), interpolation=cv2.INTER_AREA)
    wide = sum(_mean(small, 2 * (window // (2 * factor)) + 1, share) for window, share in windows[own:])
    spread = cv2.resize(np.asarray(wide), (width, height), interpolation=cv2.INTER_LINEAR)
    return np.asarray(spread if total is None else cv2.add(total, spread, total))


def _mean(sums: NDArray[Any], window: int, share: float) -> NDArray[Any]:
    mean = cv2.blur(sums, (window, window), borderType=cv2.BORDER_REFLECT)
    return np.asarray(mean if share == 1.0 else mean * np.float32(share))
