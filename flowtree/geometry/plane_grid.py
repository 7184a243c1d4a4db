"""Grids in the planes of views, and how much small things cover of their cells."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sparse
from numpy.typing import NDArray

from flowtree.geometry.footprint_means import footprint_means, optical_depth
from flowtree.geometry.projection import View, growth, to_plane

_RUN = 8  # rows that tell a crown from a tuft


@dataclass(frozen=True)
class PlaneGrid:
    """Square cells in the plane of a view.

    Attributes:
        yaw: of the view [degrees].
        left: image-right coordinate of the first column's left line [m].
        bottom: of the lowest row's lower line [m].
        cell: edge of a cell [m].
        columns: cells along image-right.
        rows: cells along up.
        distance: of the eye from the axis [m]; infinite for a parallel projection.
        eye: its height [m].
    """

    yaw: float
    left: float
    bottom: float
    cell: float
    columns: int
    rows: int
    distance: float = math.inf
    eye: float = 0.0


def cover_picture(shape: tuple[int, ...], view: View, *, cell: float, margin: int = 0) -> PlaneGrid:
    """The grid, its cells counted from the foot, that covers a picture.

    Args:
        shape: of the picture, rows and columns.
        view: where its pixels lie in the plane.
        cell: edge of a cell [m].
        margin: cells more on each side.
    """
    scale = view.metres_per_pixel
    first = int(np.floor(-view.foot[0] * scale / cell)) - margin
    last = int(np.ceil((shape[1] - view.foot[0]) * scale / cell)) + margin
    low = int(np.floor((view.foot[1] - shape[0]) * scale / cell)) - margin
    high = int(np.ceil(view.foot[1] * scale / cell)) + margin
    return PlaneGrid(
        view.yaw, first * cell, low * cell, cell, last - first, high - low, view.distance, view.eye
    )


def seen_depth(
    alpha: NDArray[np.float32], view: View, *, cell: float
) -> tuple[PlaneGrid, NDArray[np.float64]]:
    """The optical depths that a matte shows, on a grid of the given cells that covers the picture.

    Returns: the grid, and the depth of each cell (columns * rows,).
    """
    grid = cover_picture(alpha.shape, view, cell=cell)
    means = footprint_means(
        alpha, view, left=grid.left, bottom=grid.bottom, cell=cell, columns=grid.columns, rows=grid.rows
    )
    return grid, optical_depth(means).ravel()


def splat_matrix(
    grid: PlaneGrid,
    points: NDArray[np.float64],
    areas: NDArray[np.float64],
    things: NDArray[np.int64],
    count: int,
) -> sparse.csr_array:
    """Optical depth that each thing gives each cell, each point's shared among the four cells around it.

    Args:
        grid: the cells.
        points: (n, 3) world [m].
        areas: (n,) area that a parallel projection sees [m^2].
        things: (n,) the thing that each point is a part of.
        count: of the things.

    Returns: (columns * rows, count); what falls outside the grid is lost.
    """
    flat = to_plane(points, grid)
    areas = areas * growth(points, grid) ** 2
    u = (flat[:, 0] - grid.left) / grid.cell - 0.5
    v = (flat[:, 1] - grid.bottom) / grid.cell - 0.5
    i, j = np.floor(u).astype(int), np.floor(v).astype(int)
    a, b = u - i, v - j
    cells, columns, weights = [], [], []
    for di, dj, share in ((0, 0, (1 - a) * (1 - b)), (1, 0, a * (1 - b)), (0, 1, (1 - a) * b), (1, 1, a * b)):
        inside = (i + di >= 0) & (i + di < grid.columns) & (j + dj >= 0) & (j + dj < grid.rows)
        cells.append(((i + di) * grid.rows + j + dj)[inside])
        columns.append(things[inside])
        weights.append((share * areas)[inside] / grid.cell**2)
    triple = (np.concatenate(weights), (np.concatenate(cells), np.concatenate(columns)))
    return sparse.csr_array(triple, shape=(grid.columns * grid.rows, count))


def stem_cells(grid: PlaneGrid, depth: NDArray[np.float64], width: float) -> NDArray[np.bool_]:
    """Cells (columns * rows,) of the stem, from height 0 to where most rows hold more than ``width`` [m].

    Most: of the next ``_RUN`` rows three quarters, so that one wide row (a flare, a tuft) does not count.
    What stands farther than ``width`` from the middle of what a row holds is none of it: a lone low bough.
    """
    cover = -np.expm1(-depth.reshape(grid.columns, grid.rows))
    held = cover.sum(axis=0) * grid.cell
    ground = min(max(0, round(-grid.bottom / grid.cell)), grid.rows)
    wide = np.concatenate([held[ground:] > width, np.zeros(_RUN)])
    share = np.convolve(wide, np.ones(_RUN) / _RUN, mode="valid")[: grid.rows - ground]
    starts = np.flatnonzero((share >= 0.75) & (wide[: len(share)] > 0))
    narrow = np.arange(grid.rows) < ground + (starts[0] if len(starts) else 0)
    run = np.cumsum(cover, axis=0)
    middle = np.argmax(run >= 0.5 * run[-1], axis=0)
    aside = np.abs(np.arange(grid.columns)[:, None] - middle) * grid.cell > width
    stem: NDArray[np.bool_] = narrow & ~(aside & (np.arange(grid.rows) >= ground))
    return stem.ravel()
