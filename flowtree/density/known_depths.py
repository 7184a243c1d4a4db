"""What one matte says about the optical depth along the rays of a grid, and where it says nothing."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flowtree.geometry.footprint_means import footprint_means, optical_depth
from flowtree.model.camera import Camera
from flowtree.model.matte import Matte

_TREE = 0.5  # alpha from which a pixel at the picture's border says that the tree goes on beyond it
_ENOUGH = 0.5  # share of a cell that must be known


def known_depths(
    matte: Matte, camera: Camera, *, left: float, cell: float, columns: int, rows: int
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Optical depth of every cell of a grid on the ground, and whether the matte knows it.

    A cell is not known where something stands before the tree, and beyond the picture where the tree leaves
    it: to the sides from the lowest to the highest row in which the matte touches that border, above and
    below over the whole width. Elsewhere beyond the picture there is nothing.

    Args:
        matte: of the view.
        camera: its own.
        left: [m], image-right coordinate of the grid's first line.
        cell: edge of a cell [m].
        columns: cells along image-right.
        rows: cells up from the ground.

    Returns: depths (columns, rows), 0 where not known, row 0 the lowest; which of them are known.
    """

    def mean(picture: NDArray[np.float32]) -> NDArray[np.float64]:
        return footprint_means(picture, camera, left=left, bottom=0.0, cell=cell, columns=columns, rows=rows)

    beyond = _beyond(matte.alpha, camera, left, cell, columns, rows)
    hidden = matte.unknown is not None and bool(matte.unknown.any())
    if not hidden and not beyond.any():
        return optical_depth(mean(matte.alpha)), np.ones((columns, rows), np.bool_)
    clear = np.ones(matte.alpha.shape, np.float32)
    outside = 1.0 - mean(clear)
    if matte.unknown is not None:
        clear[matte.unknown] = 0.0
    share = mean(clear) + np.where(beyond, 0.0, outside)
    known = share >= _ENOUGH
    alpha = np.divide(mean(matte.alpha * clear), share, out=np.zeros_like(share), where=known)
    return optical_depth(alpha), known


def _beyond(
    alpha: NDArray[np.float32], camera: Camera, left: float, cell: float, columns: int, rows: int
) -> NDArray[np.bool_]:
    """Cells (columns, rows) of which the tree may fill what lies beyond the picture."""
    scale = camera.metres_per_pixel
    line_x = left + cell * np.arange(columns + 1)
    line_y = cell * np.arange(rows + 1)
    low_x, high_x = -camera.foot[0] * scale, (camera.width - camera.foot[0]) * scale
    low_y, high_y = (camera.foot[1] - camera.height) * scale, camera.foot[1] * scale
    beyond = np.zeros((columns, rows), np.bool_)
    for pixels, across in ((alpha[:, 0], line_x[:-1] < low_x), (alpha[:, -1], line_x[1:] > high_x)):
        touched = np.flatnonzero(pixels >= _TREE)
        if len(touched):
            low, high = ((camera.foot[1] - y) * scale for y in (touched[-1] + 1, touched[0]))
            beyond |= across[:, None] & ((line_y[1:] > low) & (line_y[:-1] < high))
    for pixels, up in ((alpha[0], line_y[1:] > high_y), (alpha[-1], line_y[:-1] < low_y)):
        if (pixels >= _TREE).any():
            beyond |= up
    return beyond
