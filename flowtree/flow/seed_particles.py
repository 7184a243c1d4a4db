"""Where the particles start (Particle Flows, section 6)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flowtree.geometry.morton import morton_code
from flowtree.model.volume import DensityVolume


def seed_particles(volume: DensityVolume, count: int, *, seed: int = 0) -> NDArray[np.float32]:
    """Random places in the voxels, in proportion to their density.

    Unlike the paper's independent draws, the draws are stratified: the voxels are put on a space-filling
    (Morton) curve, and each of ``count`` equal shares of the total density gets one particle. Every place
    keeps its probability, but particles neither clump nor leave gaps.

    Args:
        volume: that holds density.
        count: particles.
        seed: of the draws.

    Returns: (count, 3) float32 [m].
    """
    filled = np.argwhere(volume.density > 0)
    filled = filled[np.argsort(morton_code(filled), kind="stable")]
    share = np.cumsum(volume.density[tuple(filled.T)], dtype=np.float64)
    random = np.random.default_rng(seed)
    draws = (np.arange(count) + random.random(count)) * (share[-1] / count)
    voxel = filled[np.minimum(np.searchsorted(share, draws, side="right"), len(filled) - 1)]
    place = volume.origin + (voxel + random.random((count, 3))) * float(volume.voxel)
    return np.asarray(place, np.float32)
