import dataclasses

import numpy as np

from flowtree.flow.count_particles import count_particles
from flowtree.model.volume import DensityVolume


def test_the_number_grows_with_the_crown_between_two_ends():
    volume = DensityVolume(np.full((10, 10, 10), 0.35, np.float32), np.float32([-0.5, 0, -0.5]), 0.1)
    scales = (0.0, 1e-3, 0.7, 1.0, 1.4, 1e3, 1e6)
    counts = [count_particles(dataclasses.replace(volume, density=volume.density * s)) for s in scales]
    assert counts == sorted(counts)
    assert counts[1] < counts[3] < counts[5]
    assert counts[0] == counts[1] >= 100
    assert counts[5] == counts[6] <= 8000  # a few times the most that the paper uses


def test_the_number_does_not_know_metres():
    """Twice as large with the same picture: the extinction per metre halves."""
    volume = DensityVolume(np.full((10, 10, 10), 0.35, np.float32), np.float32([-0.5, 0, -0.5]), 0.1)
    large = DensityVolume(volume.density / 2, volume.origin * 2, 0.2)
    assert abs(count_particles(volume) - count_particles(large)) <= 1
