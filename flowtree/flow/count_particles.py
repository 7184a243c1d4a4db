"""How many particles a crown asks for (Particle Flows, section 6)."""

from __future__ import annotations

import numpy as np

from flowtree.model.volume import DensityVolume

_MOST = 7000  # particles at most, unless asked for more; the paper has 500 to 2000
_FEWEST = 5000
_PER_DEPTH = 16000.0  # particles for a crown whose optical depth, over all of a view, is the height squared


def count_particles(volume: DensityVolume) -> int:
    """Particles in proportion to how much crown there is, so that a sparse one is not crowded with branches.

    The paper adapts the number by hand. Here it follows the volume's total extinction, which is what a view
    sees of the tree, in units of the squared height.
    """
    height = volume.voxel * volume.density.shape[1]
    depth = float(volume.density.sum(dtype=np.float64)) * volume.voxel**3 / height**2
    return int(np.clip(_PER_DEPTH * depth, _FEWEST, _MOST))
