"""Means of a picture over the cells of a grid in a view's plane, and the depth they stand for."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from flowtree.geometry.projection import View

#: An opaque pixel hides how much is behind it: alpha is capped here before the logarithm (a depth of 4.6).
OPAQUE = 0.99


def footprint_means(
    picture: NDArray[np.float32],
    view: View,
    *,
    left: float,
    bottom: float,
    cell: float,
    columns: int,
    rows: int,
) -> NDArray[np.float64]:
    """Averages a picture over the cells of a grid in the view's plane (Particle Flows, section 5).

    The mean is exact for fractional borders: the picture is integrated once and the integral sampled at the
    grid lines. Outside the picture there is nothing (0).

    Args:
        picture: (h, w) seen by the view.
        view: where its pixels lie in the plane.
        left: [m], image-right coordinate of the grid's first line.
        bottom: [m], height of the grid's lowest line.
        cell: edge of a cell [m].
        columns: cells along image-right.
        rows: cells along up.

    Returns: (columns, rows) means; row 0 is the lowest.
    """
    scale = view.metres_per_pixel
    lines_x = view.foot[0] + (left + cell * np.arange(columns + 1)) / scale
    lines_y = view.foot[1] - (bottom + cell * np.arange(rows + 1)) / scale
    across = _integrate(picture.astype(np.float64), lines_y, axis=0)
    both = _integrate(across, lines_x, axis=1)
    sums = np.diff(np.diff(both, axis=0), axis=1)  # rows run upwards, so the first difference is negative
    return np.asarray(-sums.T / (cell / scale) ** 2)


def optical_depth(alpha: NDArray[np.float64]) -> NDArray[np.float64]:
    """Depth -ln(1 - alpha) of a mean alpha, capped where the picture is opaque."""
    return np.asarray(-np.log1p(-np.clip(alpha, 0.0, OPAQUE)))


def _integrate(values: NDArray[Any], lines: NDArray[Any], *, axis: int) -> NDArray[np.float64]:
    """The cumulative sum along an axis, sampled linearly at fractional pixel borders."""
    total = np.concatenate([np.zeros_like(values.take([0], axis)), np.cumsum(values, axis)], axis)
    n = values.shape[axis]
    place = np.clip(lines, 0, n)
    below = np.minimum(place.astype(int), n - 1)
    shape = [1, 1]
    shape[axis] = len(lines)
    part = (place - below).reshape(shape)
    return np.asarray(total.take(below, axis) * (1 - part) + total.take(below + 1, axis) * part)
