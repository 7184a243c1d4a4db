"""The small picture on which livewire paths are searched."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import ArrayLike, NDArray

from flowtree import check
from flowtree.model.matte import Matte
from flowtree.model.photo import Photo

_MARGIN = 0.04  # of the tree's height, around it: room for a path that leaves the matte for a moment
_SOLID = 0.1  # alpha from which a pixel counts for the tree's box
_MOST_CELLS = 130_000  # of a very wide tree: keeps one Dijkstra under 30 ms
_FAINT = 1e-3  # what a pixel's colour weighs that is no tree
_MOST_ENLARGED = 4.0  # times; a path on a tree of few pixels would otherwise be all steps


@dataclass(frozen=True)
class WorkingGrid:
    """The tree's box of the working picture, area-averaged to few cells; row 0 on top.

    Attributes:
        alpha: (h, w) float32 in 0..1.
        lab: (h, w, 3) float32, CIE Lab of the tree's colour, without what is beside a limb at its edges.
        scale: cells per working pixel.
        corner: (x, y) [working pixels] of the grid's upper left corner.
        tall: the tree's height [cells], the unit of every length on the grid.
    """

    alpha: NDArray[np.float32]
    lab: NDArray[np.float32]
    scale: float
    corner: tuple[int, int]
    tall: float

    def to_cells(self, pixels: ArrayLike) -> NDArray[np.float64]:
        """Working pixels (n, 2) as (x, y) in cells (n, 2), cell centres at +0.5."""
        return (np.asarray(pixels, np.float64) - self.corner) * self.scale

    def to_pixels(self, cells: ArrayLike) -> NDArray[np.float64]:
        """Cells (n, 2) as (x, y) in working pixels (n, 2)."""
        return np.asarray(cells, np.float64) / self.scale + self.corner

    def cell_at(self, cells: ArrayLike) -> NDArray[np.intp]:
        """(row, column) (n, 2) of the cell that holds each (x, y), the nearest one for points outside."""
        flat = np.floor(np.asarray(cells, np.float64)[:, ::-1])
        return np.clip(flat, 0, np.array(self.alpha.shape) - 1).astype(np.intp)


def cut_working_grid(photo: Photo, matte: Matte, marks: ArrayLike, height: int) -> WorkingGrid:
    """Cuts the tree out of picture and matte and averages it down to ``height`` cells.

    Args:
        photo: gives the colours; only where it is the picture itself that counts, not the matte's foreground.
        matte: of the same size.
        marks: (n, 2) [working pixels], what must lie inside besides the tree: foot, seeds, strokes. Marks
            outside the picture are left outside.
        height: of the tree [cells].

    Raises:
        InputError: the sizes differ, or no pixel of the matte is tree.
    """
    check.require(
        matte.alpha.shape == photo.rgb.shape[:2],
        "matte",
        f"must have the photo's size {photo.rgb.shape[:2]}",
        matte.alpha.shape,
        "make the matte from this photo",
    )
    alpha = check.array(matte.alpha, "matte alpha", shape=(None, None), low=0.0, high=1.0)
    solid = alpha > _SOLID
    check.require(bool(solid.any()), "matte", "needs a tree in it", "an alpha that is empty", "mark the tree")
    rows, columns = np.flatnonzero(solid.any(axis=1)), np.flatnonzero(solid.any(axis=0))
    high, wide = alpha.shape
    points = np.clip(np.asarray(marks, np.float64).reshape(-1, 2), 0, (wide, high))
    tall = float(max(rows[-1] + 1 - rows[0], 2))
    margin = int(np.ceil(_MARGIN * tall)) + 1
    left = max(0, int(min(columns[0], *points[:, 0])) - margin)
    top = max(0, int(min(rows[0], *points[:, 1])) - margin)
    right = min(wide, int(max(columns[-1] + 1, *points[:, 0])) + margin)
    bottom = min(high, int(max(rows[-1] + 1, *points[:, 1])) + margin)
    scale = min(height / tall, (_MOST_CELLS / ((right - left) * (bottom - top))) ** 0.5, _MOST_ENLARGED)
    size = (max(2, round((right - left) * scale)), max(2, round((bottom - top) * scale)))
    method = cv2.INTER_AREA if scale < 1.0 else cv2.INTER_LINEAR
    box = np.s_[top:bottom, left:right]
    small = cv2.resize(alpha[box], size, interpolation=method)
    weight = np.maximum(alpha[box].astype(np.float32), _FAINT)
    color = cv2.resize(photo.rgb[box] * weight[..., None], size, interpolation=method)
    color = color / (255.0 * cv2.resize(weight, size, interpolation=method)[..., None])
    lab = cv2.cvtColor(np.clip(color, 0.0, 1.0).astype(np.float32), cv2.COLOR_RGB2LAB)
    return WorkingGrid(
        np.clip(small, 0.0, 1.0).astype(np.float32), lab.astype(np.float32), scale, (left, top), tall * scale
    )
