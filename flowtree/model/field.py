"""The direction field of one view."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class DirectionField:
    """Directions in the plane of one view (image-right, up), sampled at the centres of a grid of cells.

    Attributes:
        vectors: (rows, columns, 2) float32, of length <= 1; row 0 is the lowest.
        origin: (2,) float32 [m], the lower left corner of cell (0, 0) in the view's plane.
        cell: (2,) float32 [m], width and height of a cell.
        yaw: of the view [degrees].
    """

    vectors: NDArray[np.float32]
    origin: NDArray[np.float32]
    cell: NDArray[np.float32]
    yaw: float
