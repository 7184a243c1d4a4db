"""How alike two alpha pictures of a tree are: the project's measure of fidelity."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flowtree import check
from flowtree.model.camera import Camera

# Cells along the tree's height: coarse enough that two leaves need not lie in the same place.
_CELLS = 64


def soft_iou(
    alpha: NDArray[np.float32],
    camera: Camera,
    other: NDArray[np.float32],
    other_camera: Camera,
    *,
    height: float,
    cells: int = _CELLS,
) -> float:
    """Soft intersection over union of two pictures of one view: 1 equal, 0 without anything in common.

    Both are averaged by area onto one grid of square cells, ``cells`` of them from foot to top, that covers
    both pictures and has its origin at the foot; then ``sum(min) / sum(max)``. The pictures may differ in
    size and scale; outside a picture there is nothing.

    Args:
        alpha: (h, w) in 0..1.
        camera: its view.
        other: (h2, w2) in 0..1.
        other_camera: its view.
        height: of the tree [m].
        cells: along the height.

    Returns: 0..1; 1 where both pictures are empty.

    Raises:
        InputError: a picture that does not fit its camera or leaves 0..1, a height that is not positive.
    """
    usable = bool(np.isfinite(height)) and height > 0
    check.require(usable, "height", "must be positive", height, "give the tree's height in metres")
    pictures = [
        (check.array(picture, name, shape=(view.height, view.width), low=0.0, high=1.0), view)
        for picture, view, name in ((alpha, camera, "alpha"), (other, other_camera, "the other alpha"))
    ]
    cell = height / cells
    across, along = (
        _grid([_borders(view, axis) for _, view in pictures], cell) for axis in ("across", "along")
    )
    first, second = (
        _averages(_borders(view, "along"), along)
        @ picture.astype(np.float64)
        @ _averages(_borders(view, "across"), across).T
        for picture, view in pictures
    )
    union = float(np.maximum(first, second).sum())
    return float(np.minimum(first, second).sum()) / union if union > 0 else 1.0


def _borders(view: Camera, axis: str) -> NDArray[np.float64]:
    """The borders of a picture's columns (left to right) or rows (top to bottom) from the foot [m]."""
    count, foot = (view.width, view.foot[0]) if axis == "across" else (view.height, view.foot[1])
    return np.asarray((np.arange(count + 1) - foot) * view.metres_per_pixel, np.float64)


def _grid(borders: list[NDArray[np.float64]], cell: float) -> NDArray[np.float64]:
    """Borders of cells that cover all the given ones, with one at 0."""
    low = np.floor(min(b[0] for b in borders) / cell)
    high = np.ceil(max(b[-1] for b in borders) / cell)
    return np.asarray(np.arange(low, high + 1) * cell, np.float64)


def _averages(borders: NDArray[np.float64], grid: NDArray[np.float64]) -> NDArray[np.float64]:
    """(cells, pixels): the share of each cell that each pixel covers."""
    low = np.maximum(borders[None, :-1], grid[:-1, None])
    high = np.minimum(borders[None, 1:], grid[1:, None])
    return np.asarray(np.clip(high - low, 0.0, None) / (grid[1] - grid[0]), np.float64)
