"""Follows the trunk from the crown down to the ground by its two edges."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

_RATIO, _WIDTHS, _THINNEST = 1.3, 12, 0.004  # half widths tried: times the picture's height
_THRESHOLD = 5.0  # contrast with both sides that pays for a row [CIELAB]
_WORTH = 1.5  # contrast above the threshold that the last stretch must have [CIELAB]
_ENOUGH = 16.0  # contrast beyond which more makes no better a trunk [CIELAB]
_OFF_CENTRE = 40.0  # cost of standing a whole crown's width beside its middle
_SHIFT, _NARROW, _WIDEN = 2.5, 8.0, 3.0  # cost of a column aside, of a step to the thinner, to the wider
_NEVER = np.float32(-1e9)


@dataclass(frozen=True)
class Trunk:
    """A band that runs down the picture.

    Attributes:
        rows: (n,) int64, consecutive, downwards.
        centre: (n,) int64, column.
        half: (n,) int64, half width [pixels].
        contrast: (n,) float32, with the paler of its two sides, less the threshold.
    """

    rows: NDArray[np.int64]
    centre: NDArray[np.int64]
    half: NDArray[np.int64]
    contrast: NDArray[np.float32]


@dataclass(frozen=True)
class Bands:
    """How much upright bands differ from what lies left and right of them.

    Attributes:
        sizes: (k,) int64, half widths [pixels].
        contrast: (k, h, w) float32 [CIELAB], with the less different side.
    """

    sizes: NDArray[np.int64]
    contrast: NDArray[np.float32]


def measure_bands(lab: NDArray[np.float32]) -> Bands:
    """Measures bands of every width around every pixel (h, w, 3) CIELAB."""
    height = lab.shape[0]
    sizes = np.unique(np.rint(height * _THINNEST * _RATIO ** np.arange(_WIDTHS)).clip(1).astype(np.int64))
    return Bands(sizes, _band_contrast(lab, sizes))


def trace_trunk(bands: Bands, start: NDArray[np.bool_], *, centre: float, width: float) -> Trunk | None:
    """Finds the vertical band that starts in the crown and differs most from what lies left and right of it.

    A minimal path over (column, half width), row by row: a row pays the contrast of the band with the less
    different of its sides, less a threshold; moving aside and getting thinner downwards cost. The path starts
    anywhere in the lower two thirds of ``start`` and ends where going on would not pay: at the ground.
    Lightness or hue decide alike, so that a pale stem before a hedge and a dark one before a lawn are found.

    Args:
        bands: of the picture.
        start: (h, w) where a path may begin: the crown.
        centre: column of the crown's middle.
        width: of the crown [pixels].

    Returns: the band, or None where nothing pays.
    """
    gain, sizes = bands.contrast, bands.sizes
    aside = (np.arange(gain.shape[2]) - centre) / max(width, 1.0)
    pay = gain - (_THRESHOLD + _OFF_CENTRE * aside**2).astype(np.float32)
    rows, columns, chosen = _best_path(pay, start)
    if len(rows) == 0:
        return None
    contrast = gain[chosen, rows, columns] - np.float32(_THRESHOLD)
    # Stripes in the grass pay a little: the end must be worth more than the way there.
    end = int(np.argmax(np.cumsum(contrast - _WORTH))) + 1
    return Trunk(rows[:end], columns[:end], sizes[chosen[:end]], contrast[:end])


def _band_contrast(lab: NDArray[np.float32], sizes: NDArray[np.int64]) -> NDArray[np.float32]:
    """Contrast (k, h, w) of a band of each half width with the less different of its flanks."""
    height = lab.shape[0]
    tall = 2 * max(1, round(0.02 * height)) + 1
    smooth: NDArray[Any] = cv2.GaussianBlur(lab, (1, tall), sigmaX=0.01, sigmaY=0.007 * height)
    reach = int(2 * sizes.max() + 4)
    sums, squares = _running_sums(smooth, reach), _running_sums(smooth**2, reach)
    contrast = np.empty((len(sizes), *lab.shape[:2]), np.float32)
    for k, half in enumerate(int(size) for size in sizes):
        flank = max(2, half)
        inner = _mean(sums, reach, -half, half)
        spread = np.sqrt(np.maximum(_mean(squares, reach, -half, half) - inner**2, 0.0).sum(axis=2))
        left = inner - _mean(sums, reach, -half - 1 - flank, -half - 2)
        right = inner - _mean(sums, reach, half + 2, half + 1 + flank)
        edge = np.minimum(np.linalg.norm(left, axis=2), np.linalg.norm(right, axis=2)) - 0.5 * spread
        contrast[k] = np.where(edge > 0.0, _ENOUGH * (1.0 - np.exp(-edge / _ENOUGH)), edge)
        if half < 0.0075 * height:
            contrast[k] -= 2.5  # posts and rails are thinner than trunks
    return contrast


def _running_sums(values: NDArray[np.float32], reach: int) -> NDArray[np.float64]:
    padded = np.pad(values, ((0, 0), (reach + 1, reach), (0, 0)), mode="edge").astype(np.float64)
    return np.cumsum(padded, axis=1)


def _mean(sums: NDArray[np.float64], reach: int, first: int, last: int) -> NDArray[np.float32]:
    """Mean over the columns from x + first to x + last."""
    width = sums.shape[1] - 2 * reach - 1
    high, low = reach + 1 + last, reach + first
    mean = (sums[:, high : high + width] - sums[:, low : low + width]) / (last - first + 1)
    return mean.astype(np.float32)


def _best_path(
    pay: NDArray[np.float32], start: NDArray[np.bool_]
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    """Rows, columns and width indices of the path that pays most; empty where none pays."""
    sizes, height, width = pay.shape
    moves = [(dk, dx) for dk in (-1, 0, 1) for dx in (-1, 0, 1)]
    steps = [
        (
            (_shifted(sizes, dk), _shifted(width, dx)),
            (_shifted(sizes, -dk), _shifted(width, -dx)),
            np.float32(_SHIFT * abs(dx) + (0.0 if dk == 0 else _WIDEN if dk < 0 else _NARROW)),
        )
        for dk, dx in moves
    ]
    shown = np.flatnonzero(start.any(axis=1))
    came = np.zeros((height, sizes, width), np.int8)
    value = np.full((sizes, width), _NEVER)
    best, end = np.float32(0.0), (0, 0, -1)
    for row in range(int(shown[0] + 0.35 * np.ptp(shown)) if len(shown) else height, height):
        top = np.where(start[row], np.float32(0.0), _NEVER)[None, :].repeat(sizes, axis=0)
        for number, (source, target, cost) in enumerate(steps, start=1):
            reached = value[source] - cost
            better = reached > top[target]
            np.copyto(top[target], reached, where=better)
            np.copyto(came[row][target], np.int8(number), where=better)
        value = top + pay[:, row]
        peak = value.max()
        if peak > best:
            size, column = divmod(int(value.argmax()), width)
            best, end = peak, (size, column, row)
    path: list[tuple[int, int, int]] = []
    k, x, row = end
    while row >= 0:
        path.append((row, x, k))
        number = int(came[row, k, x])
        if number == 0:
            break
        dk, dx = moves[number - 1]
        k, x, row = k + dk, x + dx, row - 1
    taken = np.array(path[::-1], np.int64).reshape(-1, 3)
    return taken[:, 0], taken[:, 1], taken[:, 2]


def _shifted(size: int, by: int) -> slice:
    return slice(max(0, by), size + min(0, by))
