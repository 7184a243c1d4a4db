"""The density where something is."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flowtree.model.volume import DensityVolume


def look_up_density(points: NDArray[np.float64], volume: DensityVolume) -> NDArray[np.float32]:
    """Extinction [1/m] of the voxels that points (m, 3) [m] lie in; 0 outside."""
    voxel = np.floor((points - volume.origin) / volume.voxel).astype(np.int32)
    shape = np.array(volume.density.shape, np.int32)
    within = ((voxel >= 0) & (voxel < shape)).all(axis=1)
    return np.where(within, volume.density[tuple(np.clip(voxel, 0, shape - 1).T)], np.float32(0))
