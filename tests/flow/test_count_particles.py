import dataclasses

import numpy as np

from flowtree.flow.count_particles import count_particles
from flowtree.model.volume import DensityVolume


def test_the_number_grows_with_the_crown_within_the_papers_range():
    volume = DensityVolume(np.full((10, 10, 10), 0.2, np.float32), np.float32([-0.5, 0, -0.5]), 0.1)
    denser = dataclasses.replace(volume, density=2 * volume.density)
    assert 300 < count_particles(volume) < count_particles(denser) < 2000
    assert count_particles(dataclasses.replace(volume, density=volume.density * 1e-3)) == 300
    assert count_particles(dataclasses.replace(volume, density=volume.density * 1e3)) == 2000


def test_the_number_does_not_know_metres():
    """Twice as large with the same picture: the extinction per metre halves."""
    volume = DensityVolume(np.full((10, 10, 10), 0.2, np.float32), np.float32([-0.5, 0, -0.5]), 0.1)
    large = DensityVolume(volume.density / 2, volume.origin * 2, 0.2)
    assert abs(count_particles(volume) - count_particles(large)) <= 1
