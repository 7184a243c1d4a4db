"""What stands before the sky in the middle of the picture, and where the horizon runs."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

_OUTERMOST = 0.03  # share of a row's pixels beyond its edge on each side
_MARGIN = 0.03  # of the height: hedges are uneven by that much above the horizon


@dataclass(frozen=True)
class Crown:
    """The part of the tree that shows before the sky.

    Attributes:
        core: (h, w) bool.
        horizon: (w,) float64, the row where the sky ends.
        left: (h,) float64, column of the crown's left edge, continued below what shows.
        right: (h,) float64, the right edge.
        centre: column of its centre of mass.
        width: [pixels], that three quarters of its rows do not exceed: a palm's stem is no crown.
    """

    core: NDArray[np.bool_]
    horizon: NDArray[np.float64]
    left: NDArray[np.float64]
    right: NDArray[np.float64]
    centre: float
    width: float


def find_crown(
    solid: NDArray[np.bool_], sky: NDArray[np.bool_], wanted: NDArray[np.bool_] | None = None
) -> Crown | None:
    """Picks the central thing before the sky and continues its outline below the horizon.

    The horizon is the lowest sky of every column, levelled across hills: a tree hides the horizon, and
    between two columns that show it lower it cannot be higher.

    Args:
        solid: (h, w) bool, pixels that are not sky.
        sky: (h, w) bool.
        wanted: (h, w) bool, pixels known to be tree (scribbles, picked colours); what holds them is kept.

    Returns: the crown, or None where nothing stands before the sky.
    """
    height, width = solid.shape
    horizon = _find_horizon(sky)
    rows, columns = np.mgrid[:height, :width]
    above = solid & (rows <= horizon[None, :] - _MARGIN * height)
    if wanted is not None:
        above |= wanted
    if above.sum() < 0.002 * height * width:
        return None
    reach = 2 * max(1, round(0.006 * height)) + 1
    joined = cv2.dilate(above.astype(np.uint8), np.ones((reach, reach), np.uint8))
    count, parts = cv2.connectedComponents(joined, connectivity=8)
    central = np.exp(-(((columns - width / 2) / (0.22 * width)) ** 2)) * above
    if wanted is not None:
        central += 100.0 * wanted
    mass = np.bincount(parts.ravel(), central.ravel(), count)
    mass[0] = 0.0
    core = (mass >= 0.08 * mass.max())[parts] & above
    share = core.sum(axis=0) / core.sum()
    centre = float((share * np.arange(width)).sum())
    left, right = _outline(core, horizon, centre)
    shown = np.flatnonzero(core.any(axis=1))
    return Crown(
        core, horizon, left, right, centre, max(4.0, float(np.quantile((right - left)[shown], 0.75)))
    )


def _find_horizon(sky: NDArray[np.bool_]) -> NDArray[np.float64]:
    height, width = sky.shape
    clear = cv2.morphologyEx(sky.astype(np.uint8), cv2.MORPH_OPEN, np.ones((3, 3), np.uint8)) > 0
    lowest = np.where(clear.any(axis=0), height - 1 - np.argmax(clear[::-1], axis=0), 0).astype(np.float64)
    lowest = ndimage.median_filter(lowest, min(7, width), mode="nearest")
    level: NDArray[np.float64] = np.minimum(
        np.maximum.accumulate(lowest), np.maximum.accumulate(lowest[::-1])[::-1]
    )
    return level


def _outline(
    core: NDArray[np.bool_], horizon: NDArray[np.float64], centre: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The left and right edge of every row; where the core ends they go on as they went."""
    height, width = core.shape
    edges = np.full((height, 2), np.nan)
    for row in np.flatnonzero(core.sum(axis=1) > 1):
        edges[row] = _inner_columns(np.flatnonzero(core[row]))
    filled = ~np.isnan(edges[:, 0])
    if not filled.any():
        return np.full(height, centre), np.full(height, centre)
    widest = float((edges[filled, 1] - edges[filled, 0]).max())
    off = filled & ~(np.abs(np.nan_to_num(edges.mean(axis=1)) - centre) < 0.3 * widest)
    lines: list[NDArray[np.float64]] = []
    ends: list[int] = []
    for side, sign in ((0, -1), (1, 1)):
        usable = filled & ~off
        for row in np.flatnonzero(usable):
            edge = int(edges[row, side])
            beside = horizon[max(0, edge - width // 16) : max(0, edge - 2)]
            if sign > 0:
                beside = horizon[edge + 3 : edge + width // 16 + 1]
            if beside.size and row >= beside.min() - _MARGIN * height - 1:
                usable[row] = False  # this edge is where the horizon steps, not where the crown ends
        known = np.flatnonzero(usable if usable.sum() > 3 else filled)
        ends.append(int(known[-1]))
        lines.append(_continue_edge(known, edges[known, side], sign, height))
    _mirror_edge(lines, ends, centre)
    return lines[0], lines[1]


def _inner_columns(columns: NDArray[np.intp]) -> tuple[float, float]:
    """The 3rd and 97th percentile of ascending columns; `np.quantile` takes ten times as long for so few."""
    place = _OUTERMOST * (len(columns) - 1)
    low = int(place)
    left = columns[low] + (columns[low + 1] - columns[low]) * (place - low)
    right = columns[-1 - low] - (columns[-1 - low] - columns[-2 - low]) * (place - low)
    return float(left), float(right)


def _mirror_edge(lines: list[NDArray[np.float64]], ends: list[int], centre: float) -> None:
    """Where one side is hidden and the other still shows that the crown narrows, both narrow alike."""
    hidden, shown = (0, 1) if ends[0] < ends[1] else (1, 0)
    first = min(ends)
    half = np.abs(lines[shown] - centre)
    narrowed = np.abs(lines[hidden][first] - centre) * half / max(float(half[first]), 1.0)
    below = slice(first + 1, None)
    if hidden == 0:
        lines[0][below] = np.maximum(lines[0][below], (centre - narrowed)[below])
    else:
        lines[1][below] = np.minimum(lines[1][below], (centre + narrowed)[below])


def _continue_edge(
    rows: NDArray[np.intp], edge: NDArray[np.float64], sign: int, height: int
) -> NDArray[np.float64]:
    """Interpolates between known rows; below the last one it follows the slope of the last third."""
    every = np.arange(height)
    line = ndimage.gaussian_filter1d(np.interp(every, rows, edge), 3.0)
    first, last = int(rows[0]), int(rows[-1])
    start = max(first, last - max(3, round(0.3 * (last - first))))
    tail = np.arange(start, last + 1)
    slope = float(np.polyfit(tail, line[tail], 1)[0]) * sign if len(tail) > 3 else 0.0
    slope = min(max(slope, -0.6), 0.5)
    below = np.clip(every - last, 0, 0.5 * (last - first))
    line = np.where(every > last, float(np.median(edge[-5:])) + sign * slope * below, line)
    smooth: NDArray[np.float64] = ndimage.gaussian_filter1d(line, 2.0)
    return smooth
