"""What tapered segments cover of the cells of a view."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sparse
from numpy.typing import NDArray

from flowtree.geometry.plane_grid import PlaneGrid, splat_matrix
from flowtree.geometry.projection import view_axes


def segment_depth(
    grid: PlaneGrid,
    start: NDArray[np.float64],
    end: NDArray[np.float64],
    radius: NDArray[np.float64],
    things: NDArray[np.int64],
    count: int,
) -> sparse.csr_array:
    """Optical depth that each thing's segments give each cell: their silhouettes' area over the cell's.

    A segment is sampled along its length and, where it is wider than a cell, across.

    Args:
        grid: the cells.
        start: (n, 3) [m].
        end: (n, 3) [m].
        radius: (n,) mean radius [m].
        things: (n,) the thing that each segment is a part of.
        count: of the things.

    Returns: (columns * rows, count).
    """
    right, up, _ = view_axes(grid.yaw)
    along = end - start
    flat = np.stack([along @ right, along @ up], axis=1)
    length = np.linalg.norm(flat, axis=1)
    steps = np.maximum(np.ceil(length / grid.cell), 1).astype(int)
    across = np.maximum(np.ceil(2 * radius / grid.cell), 1).astype(int)
    total = steps * across
    which = np.repeat(np.arange(len(start)), total)
    number = np.arange(int(total.sum())) - np.repeat(np.cumsum(total) - total, total)
    way = (number % steps[which] + 0.5) / steps[which]
    side = ((number // steps[which] + 0.5) / across[which] * 2 - 1) * radius[which]
    unit = flat / np.maximum(length, 1e-12)[:, None]
    sideways = unit[which, 1, None] * right - unit[which, 0, None] * up
    points = start[which] + along[which] * way[:, None] + sideways * side[:, None]
    areas = (2 * radius * length / total)[which]
    return splat_matrix(grid, points, areas, things[which], count)


def rods_depth(
    grid: PlaneGrid, parent: NDArray[np.int32], points: NDArray[np.float32], radius: NDArray[np.float32]
) -> NDArray[np.float64]:
    """Optical depth (columns * rows,) of a forest of rods, one from every node's parent to the node."""
    nodes = np.flatnonzero(parent >= 0)
    above = parent[nodes]
    place, width = points.astype(np.float64), radius.astype(np.float64)
    one = np.zeros(len(nodes), np.int64)
    mean = (width[nodes] + width[above]) / 2
    return np.asarray(segment_depth(grid, place[above], place[nodes], mean, one, 1).sum(axis=1)).ravel()
