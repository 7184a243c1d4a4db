import numpy as np

from flowtree.branches.look_up_density import look_up_density
from flowtree.model.volume import DensityVolume


def test_the_density_is_that_of_the_voxel_and_nothing_outside():
    density = np.arange(24, dtype=np.float32).reshape(2, 3, 4)
    volume = DensityVolume(density, np.array([-1.0, 0.0, -2.0], np.float32), 0.5)
    inside = np.argwhere(density >= 0)
    assert np.array_equal(look_up_density((inside + 0.4) * 0.5 + volume.origin, volume), density.ravel())
    outside = np.array([[-1.01, 0.1, -1.9], [0.01, 0.1, -1.9], [-0.9, 1.6, -1.9], [-0.9, 0.1, 0.1]])
    assert (look_up_density(outside, volume) == 0).all()
