"""How alike two alpha pictures of a tree are: the project's measure of fidelity."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from flowtree import check
from flowtree.geometry.footprint_means import footprint_means
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
    scaled = [(view, view.metres_per_pixel) for _, view in pictures]
    columns = _lines([(-view.foot[0] * m, (view.width - view.foot[0]) * m) for view, m in scaled], cell)
    rows = _lines([((view.foot[1] - view.height) * m, view.foot[1] * m) for view, m in scaled], cell)
    first, second = (
        footprint_means(
            picture,
            view,
            left=columns[0] * cell,
            bottom=rows[0] * cell,
            cell=cell,
            columns=columns[1] - columns[0],
            rows=rows[1] - rows[0],
        )
        for picture, view in pictures
    )
    union = float(np.maximum(first, second).sum())
    return float(np.minimum(first, second).sum()) / union if union > 0 else 1.0


def _lines(spans: list[tuple[float, float]], cell: float) -> tuple[int, int]:
    """First and last line of a grid with one line at 0 that covers all spans (low, high) [m], in cells."""
    return math.floor(min(low for low, _ in spans) / cell), math.ceil(max(high for _, high in spans) / cell)
