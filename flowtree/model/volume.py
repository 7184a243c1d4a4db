"""The voxel volume of the tree's density."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class DensityVolume:
    """Extinction of light per metre in cubic voxels, world frame.

    Attributes:
        density: (nx, ny, nz) float32, [1/m], >= 0; 0 is empty.
        origin: (3,) float32 [m], the corner of voxel (0, 0, 0) with the smallest coordinates.
        voxel: edge of a voxel [m].
    """

    density: NDArray[np.float32]
    origin: NDArray[np.float32]
    voxel: float
