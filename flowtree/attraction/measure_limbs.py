"""Where a bare tree's matte shows the middle of a limb, and how thick the limb is."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from flowtree.attraction.cut_working_grid import WorkingGrid
from flowtree.model.matte import Matte

_OPAQUE = 0.6  # alpha of wood; lace of twigs has less
_FINEST = 1.5  # [working pixels] half width of the finest limb told from its neighbours
_FINER = 1.2  # ratio of the half widths that are told apart
_THICKEST = 0.05  # of the height: half width up to which an opaque part is a limb

_Map = NDArray[np.float64]


def measure_limbs(matte: Matte, grid: WorkingGrid) -> tuple[_Map, _Map]:
    """The clearest place of every grid cell: how near its limb's middle, and the limb's half width.

    Measured in the working picture itself: on the grid two limbs side by side are one. The half width is that
    of the largest disc inside the opaque matte that covers the place.

    Args:
        matte: of the view.
        grid: of the same view.

    Returns:
        middle: (h, w) 0 at a limb's edge and beside it, 1 in its middle.
        half: (h, w) [tree heights].
    """
    tall = grid.tall / grid.scale
    opaque = np.pad((matte.alpha > _OPAQUE).astype(np.uint8), 1)
    depth = cv2.distanceTransform(opaque, cv2.DIST_L2, 5)[1:-1, 1:-1]
    half = depth.copy()
    radius = _FINEST
    while radius <= min(float(depth.max()), _THICKEST * tall):
        covered = cv2.distanceTransform((depth < radius).astype(np.uint8), cv2.DIST_L2, 5) < radius
        half[covered] = np.maximum(half[covered], radius)
        radius *= _FINER
    middle = depth / np.maximum(half, 1e-6)
    rows, columns = grid.alpha.shape
    clear, thick = np.zeros(rows * columns), np.zeros(rows * columns)
    at = np.argwhere(depth > 0)
    cell = np.floor((at[:, ::-1] + 0.5 - np.array(grid.corner)) * grid.scale).astype(int)
    inside = ((cell >= 0) & (cell < (columns, rows))).all(axis=1)
    at, cell = at[inside], cell[inside]
    flat = cell[:, 1] * columns + cell[:, 0]
    np.maximum.at(clear, flat, middle[tuple(at.T)])
    np.maximum.at(thick, flat, half[tuple(at.T)] / tall)
    return clear.reshape(rows, columns), thick.reshape(rows, columns)
