"""What a livewire pays all over a photo: for a person who draws along it."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from flowtree.attraction.cut_working_grid import cut_working_grid
from flowtree.attraction.outline_crown import outline_crown
from flowtree.attraction.stem_likeness import stem_likeness
from flowtree.attraction.weigh_structures import weigh_structures
from flowtree.model.matte import Matte
from flowtree.model.photo import Photo

_GRID = 240  # cells of the tree's height, as the attractor graph's own
_TALLEST = 400  # cells of the picture's height
_DEAR = 3.0  # cost from which all is equally dear


def livewire_cost(photo: Photo, matte: Matte) -> NDArray[np.uint8]:
    """The costs of `weigh_structures` over the whole photo, in its aspect.

    Args:
        photo: as it was read, not straightened.
        matte: of the same size.

    Returns: (h, w), h at most 400: 0 in the middle of a branch, 255 beside the tree.

    Raises:
        InputError: no pixel of the matte is tree.
    """
    row, column = np.unravel_index(int(matte.alpha.argmax()), matte.alpha.shape)
    grid = cut_working_grid(photo, matte, [[column, row]], _GRID)
    solid = np.flatnonzero((grid.alpha > 0.5).any(axis=1))
    crown = outline_crown(grid, int(solid[-1]) if len(solid) else grid.alpha.shape[0] - 1)
    cost = weigh_structures(grid, crown, np.random.default_rng(0), stem_likeness(grid, crown))
    level = np.rint(np.clip(cost / _DEAR, 0.0, 1.0) * 255.0).astype(np.uint8)
    high, wide = matte.alpha.shape
    scale = min(1.0, grid.scale, _TALLEST / high)
    canvas = np.full((max(1, round(high * scale)), max(1, round(wide * scale))), 255, np.uint8)
    left, top = (round(place * scale) for place in grid.corner)
    share = scale / grid.scale
    rows = min(max(1, round(level.shape[0] * share)), canvas.shape[0] - top)
    columns = min(max(1, round(level.shape[1] * share)), canvas.shape[1] - left)
    canvas[top : top + rows, left : left + columns] = cv2.resize(
        level, (columns, rows), interpolation=cv2.INTER_AREA
    )
    return canvas
