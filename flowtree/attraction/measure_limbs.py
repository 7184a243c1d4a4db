"""Where a bare tree's matte shows the middle of a limb, and how thick the limb is."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from flowtree.attraction.cut_working_grid import WorkingGrid
from flowtree.model.matte import Matte

_OPAQUE = 0.6  # alpha of wood; lace of twigs has less
_FINEST = 1.5  # [pixels] half width of the finest limb told from its neighbours
_RATIO = 1.2  # of half widths that are told apart
_WIDEST = 0.05  # of the height: half width up to which an opaque part is a limb
_MIDDLE = 0.7  # depth by half width from which a place is in the middle
_ASIDE = 3  # pixels across, in which the middle is looked for: a limb's line is not drawn to the pixel

_Map = NDArray[np.float32]


@dataclass(frozen=True)
class LimbWidths:
    """What of the matte is limb.

    Attributes:
        depth: (h, w) [working pixels], distance to the nearest pixel that is not opaque; 0 there.
        half: (h, w) [working pixels], radius of the largest disc inside the opaque matte that covers the
            pixel, down to a sixth less; 0 where it is not opaque.
    """

    depth: _Map
    half: _Map

    def on_grid(self, grid: WorkingGrid) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The clearest place of every cell of a grid of the same view.

        Returns:
            middle: (rows, columns) 0 at a limb's edge and beside it, 1 in its middle.
            half: (rows, columns) half width [tree heights].
        """
        middle = np.asarray(self.depth / np.maximum(self.half, np.float32(1e-6)), np.float32)
        thick = self.half * np.float32(grid.scale / grid.tall)
        return _most_per_cell(middle, grid), _most_per_cell(thick, grid)

    def at(self, pixels: NDArray[np.float64]) -> NDArray[np.float64]:
        """Half width [working pixels] of the limbs in whose middle places (n, 2) as (x, y) lie, else NaN."""
        inner = np.where(self.depth >= _MIDDLE * self.half, self.depth, np.float32(0.0))
        inner = np.asarray(cv2.dilate(inner, np.ones((_ASIDE, _ASIDE), np.uint8)), np.float32)
        place = np.floor(pixels[:, ::-1]).astype(int)
        inside = ((place >= 0) & (place < inner.shape)).all(axis=1)
        width = np.full(len(pixels), np.nan)
        # Of n pixels across the depth is n/2 or (n + 1)/2: a quarter of a pixel too much in the mean.
        seen = inner[tuple(place[inside].T)].astype(np.float64)
        width[inside] = np.where(seen > 0.0, seen - 0.25, np.nan)
        return width


def measure_limbs(matte: Matte, tall: float) -> LimbWidths:
    """Measures the opaque parts of a matte, in the working picture itself: on a grid two limbs may be one.

    Args:
        matte: of the view.
        tall: the tree's height [working pixels].
    """
    opaque = np.pad((matte.alpha > _OPAQUE).astype(np.uint8), 1)
    depth = np.asarray(cv2.distanceTransform(opaque, cv2.DIST_L2, 5), np.float32)[1:-1, 1:-1]
    half = depth.copy()
    radius = _FINEST
    while radius <= min(float(depth.max()), _WIDEST * tall):
        # Wide discs are few: what they cover lies in an ever smaller part of the picture.
        box = _grown_box(depth >= radius, int(np.ceil(radius)))
        around = cv2.distanceTransform((depth[box] < radius).astype(np.uint8), cv2.DIST_L2, 5)
        np.maximum(half[box], np.float32(radius), out=half[box], where=around < radius)
        radius *= _RATIO
    return LimbWidths(depth, np.where(depth > 0, half, np.float32(0.0)))


def _most_per_cell(values: _Map, grid: WorkingGrid) -> NDArray[np.float64]:
    """The largest of the values (h, w), >= 0, of the pixels in each cell (rows, columns); 0 without any."""
    rows, columns = grid.alpha.shape
    by_row = _most_in_runs(values, _places(values.shape[0], grid.corner[1], grid.scale), rows)
    by_cell = _most_in_runs(by_row.T, _places(values.shape[1], grid.corner[0], grid.scale), columns)
    return np.asarray(by_cell.T, np.float64)


def _places(pixels: int, corner: int, scale: float) -> NDArray[np.intp]:
    """The row (or column) of cells that each row (or column) of pixels lies in."""
    return np.asarray(np.floor((np.arange(pixels) + 0.5 - corner) * scale), np.intp)


def _most_in_runs(values: _Map, place: NDArray[np.intp], count: int) -> _Map:
    """The largest values (count, w) of the rows of each growing place from 0 on; 0 without any."""
    inside = (place >= 0) & (place < count)
    most = np.zeros((count, values.shape[1]), np.float32)
    cell, start = np.unique(place[inside], return_index=True)
    if len(cell):
        most[cell] = np.maximum.reduceat(values[inside], start)
    return most


def _grown_box(where: NDArray[np.bool_], margin: int) -> tuple[slice, slice]:
    """The part of a picture that holds all marked pixels and those around them; at least one is marked."""
    rows, columns = np.flatnonzero(where.any(axis=1)), np.flatnonzero(where.any(axis=0))
    return (
        slice(max(int(rows[0]) - margin, 0), int(rows[-1]) + margin + 1),
        slice(max(int(columns[0]) - margin, 0), int(columns[-1]) + margin + 1),
    )
