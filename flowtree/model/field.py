"""Direction fields: of one view, and around the limbs in space."""

from __future__ import annotations

import math
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
        distance: of its eye from the tree's axis [m]; infinite for a parallel projection.
        eye: its height above the foot [m].
    """

    vectors: NDArray[np.float32]
    origin: NDArray[np.float32]
    cell: NDArray[np.float32]
    yaw: float
    distance: float = math.inf
    eye: float = 0.0


@dataclass(frozen=True)
class LimbField:
    """Directions in space around the limbs, at the points of a box.

    Attributes:
        vectors: (nx, ny, nz, 3) float32; their length, 0 to 1, is how surely they lead the right way.
        corner: (3,) float32 [m], point (0, 0, 0).
        spacing: of the points [m].
    """

    vectors: NDArray[np.float32]
    corner: NDArray[np.float32]
    spacing: float
