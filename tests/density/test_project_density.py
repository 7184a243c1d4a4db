import dataclasses

import numpy as np
import pytest

from flowtree.density.project_density import project_density
from flowtree.model.camera import Camera
from flowtree.model.volume import DensityVolume


def _camera(yaw=0.0, size=64, span=4.0):
    return Camera(yaw, span / size, (size / 2, 0.9 * size), size, size)


def _box(nx=10, ny=12, nz=6, density=0.7, voxel=0.1):
    values = np.full((nx, ny, nz), density, np.float32)
    return DensityVolume(values, np.float32([-nx / 2 * voxel, 0, -nz / 2 * voxel]), voxel)


@pytest.mark.parametrize("yaw", [0.0, 90.0, 180.0, 30.0, 45.0, 75.0])
def test_a_uniform_box_hides_what_its_depth_says(yaw):
    """In the middle of the view all rays cross both of the long faces."""
    box = _box()
    alpha = project_density(box, _camera(yaw))
    turn = np.radians(yaw)
    depth = min(1.0 / max(abs(np.sin(turn)), 1e-9), 0.6 / max(abs(np.cos(turn)), 1e-9))
    row, column = 50, 31  # 0.5 m up, the two pixels beside the axis
    assert np.allclose(alpha[row, column : column + 2], -np.expm1(-0.7 * depth), atol=0.01)


@pytest.mark.parametrize("yaw", [0.0, 90.0, 30.0, 137.0])
def test_the_depth_of_a_view_holds_the_whole_volume(yaw):
    """Thin matter hides in proportion: the area times the alpha is the integral of the density."""
    rng = np.random.default_rng(0)
    box = _box(density=1.0)
    box = dataclasses.replace(box, density=(1e-3 * rng.random(box.density.shape)).astype(np.float32))
    camera = _camera(yaw, size=256)
    alpha = project_density(box, camera)
    assert alpha.sum() * camera.metres_per_pixel**2 == pytest.approx(box.density.sum() * 0.1**3, rel=0.01)


def test_opposite_views_are_mirror_images():
    box = _box()
    values = np.random.default_rng(1).random(box.density.shape).astype(np.float32)
    box = dataclasses.replace(box, density=values)
    front, back = (project_density(box, _camera(yaw)) for yaw in (20.0, 200.0))
    assert np.allclose(front, back[:, ::-1], atol=1e-6)
    mirrored = dataclasses.replace(box, density=values[::-1].copy())
    assert np.allclose(project_density(mirrored, _camera(-20.0)), front[:, ::-1], atol=1e-6)


def test_where_nothing_is_nothing_is_seen():
    alpha = project_density(_box(), _camera())
    assert alpha.shape == (64, 64)
    assert alpha.dtype == np.float32
    assert (alpha[:36] == 0).all()  # over 1.3 m
    assert (alpha[60:] == 0).all()  # under the ground
    assert (alpha[:, :20] == 0).all()
    assert alpha.max() < 1
