"""Where in a photograph the pixels of its straightened picture lie."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flowtree.model.placement import Placement


def place_pixels(placement: Placement) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Columns and rows (h, w) [pixels of the photograph] of the centres of the picture's pixels."""
    camera = placement.camera
    u, v = np.arange(camera.width) + 0.5, (np.arange(camera.height) + 0.5)[:, None]
    warp = np.eye(3) if placement.warp is None else placement.warp
    x, y, depth = (row[0] * u + row[1] * v + row[2] for row in warp)
    return x / depth, y / depth


def outside_frame(placement: Placement) -> NDArray[np.bool_]:
    """Pixels (h, w) of the straightened picture that the photograph does not show."""
    x, y = place_pixels(placement)
    columns, rows = placement.frame
    return (x < 0.0) | (x > columns) | (y < 0.0) | (y > rows)
