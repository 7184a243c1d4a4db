"""How much every pixel looks like a region, seen through several windows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations_with_replacement
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

_COARSE = 2  # moments vary slowly: they are summed on a picture this much smaller
_SEEN = 0.02  # share of a window that must belong to the region for its word to count half
_WHOLE = 1e-3  # weight of the whole picture in every window, so that none is empty


@dataclass(frozen=True)
class Window:
    """Where a region's pixels are looked for.

    Attributes:
        across: deviation of the window's weight along a row [pixels].
        along: along a column [pixels].
        trust: weight of its word beside those of other windows.
    """

    across: float
    along: float
    trust: float


def rate_likeness(
    features: NDArray[np.float32],
    weight: NDArray[np.float32],
    windows: Sequence[Window],
    *,
    noise: float,
) -> NDArray[np.float32]:
    """Logarithm of the likelihood (h, w) of every pixel's features under a region.

    In every window the region is one Gaussian. The windows are mixed; one that holds little of the region
    has little to say.

    Args:
        features: (h, w, n) float32.
        weight: (h, w) >= 0, how much a pixel belongs to the region.
        windows: at least one.
        noise: standard deviation that is added to every feature.
    """
    count = features.shape[2]
    centred = features - features.reshape(-1, count).mean(axis=0)
    pairs = list(combinations_with_replacement(range(count), 2))
    moments = [weight, *(weight * centred[..., k] for k in range(count))]
    moments += [weight * centred[..., i] * centred[..., j] for i, j in pairs]
    height, width = weight.shape
    small = (max(1, width // _COARSE), max(1, height // _COARSE))
    coarse = [cv2.resize(moment, small, interpolation=cv2.INTER_AREA) for moment in moments]
    whole = [_WHOLE * float(moment.mean()) for moment in coarse]
    logs, shares = [], []
    for window in windows:
        sums: list[NDArray[Any]] = []
        for moment, rest in zip(coarse, whole, strict=True):
            blurred = cv2.GaussianBlur(
                moment,
                (0, 0),
                sigmaX=window.across / _COARSE + 0.3,
                sigmaY=window.along / _COARSE + 0.3,
                borderType=cv2.BORDER_REFLECT,
            )
            sums.append(cv2.resize(blurred, (width, height)) + np.float32(rest))
        mass = np.maximum(sums[0], np.float32(1e-9))
        means = [total / mass for total in sums[1 : 1 + count]]
        spread = {
            (i, j): total / mass - means[i] * means[j]
            for (i, j), total in zip(pairs, sums[1 + count :], strict=True)
        }
        logs.append(_log_gaussian(centred, means, spread, noise))
        shares.append(window.trust * mass / (mass + np.float32(_SEEN)) + np.float32(1e-3))
    most = np.max(logs, axis=0)
    mixed = sum(share * np.exp(log - most) for share, log in zip(shares, logs, strict=True))
    rated: NDArray[np.float32] = most + np.log(mixed / sum(shares))
    return rated


def _log_gaussian(
    features: NDArray[np.float32],
    means: list[NDArray[Any]],
    spread: dict[tuple[int, int], NDArray[Any]],
    noise: float,
) -> NDArray[np.float32]:
    """Log-density but for a constant; the Cholesky root written out is faster than LAPACK's."""
    count = len(means)
    floor = np.float32(noise**2)
    root: dict[tuple[int, int], NDArray[Any]] = {}
    away: list[NDArray[Any]] = []
    total = np.zeros(features.shape[:2], np.float32)
    for i in range(count):
        for j in range(i):
            rest = spread[j, i] - sum(root[i, k] * root[j, k] for k in range(j))
            root[i, j] = rest / root[j, j]
        # Rounding must not take the root of less than the noise.
        variance = spread[i, i] + floor - sum(root[i, k] ** 2 for k in range(i))
        root[i, i] = np.sqrt(np.maximum(variance, floor))
        apart = features[..., i] - means[i] - sum(root[i, k] * away[k] for k in range(i))
        away.append(apart / root[i, i])
        total -= np.float32(0.5) * away[i] ** 2 + np.log(root[i, i])
    return total
