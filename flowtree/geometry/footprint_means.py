"""Means of a picture over the cells of a grid in a view's plane, and the depth they stand for."""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sparse
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

    The mean is exact for fractional borders: each pixel's row and column count by their overlap with the
    cell's. Outside the picture there is nothing (0).

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
    # Few pixels overlap a cell's rows, so a sparse product reads the picture about once.
    across = _overlaps(lines_y[::-1], picture.shape[0])[::-1] @ picture.astype(np.float64)
    return np.asarray((_overlaps(lines_x, picture.shape[1]) @ across.T) / (cell / scale) ** 2)


def optical_depth(alpha: NDArray[np.float64]) -> NDArray[np.float64]:
    """Depth -ln(1 - alpha) of a mean alpha, capped where the picture is opaque."""
    return np.asarray(-np.log1p(-np.clip(alpha, 0.0, OPAQUE)))


def _overlaps(lines: NDArray[np.floating[Any]], pixels: int) -> sparse.csr_array:
    """Length (cells, pixels) that the cells between growing lines share with the pixels (k, k + 1)."""
    place = np.clip(lines, 0, pixels)
    low, high = place[:-1], place[1:]
    first = np.floor(low).astype(int)
    count = np.maximum(np.ceil(high).astype(int) - first, 0)
    cell = np.repeat(np.arange(len(count)), count)
    pixel = first[cell] + np.arange(len(cell)) - np.repeat(np.cumsum(count) - count, count)
    share = np.minimum(high[cell], pixel + 1) - np.maximum(low[cell], pixel)
    return sparse.csr_array((share, (cell, pixel)), shape=(len(count), pixels))
