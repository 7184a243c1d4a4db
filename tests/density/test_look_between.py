"""Views of the volume from between the photographs."""

from __future__ import annotations

import numpy as np
import pytest

from flowtree.density.look_between import look_between
from flowtree.density.project_density import project_density
from flowtree.model.camera import Camera
from flowtree.model.volume import DensityVolume

random = np.random.default_rng(5)
VOLUME = DensityVolume(random.random((10, 16, 10), np.float32), np.array([-0.5, 0.0, -0.5], np.float32), 0.1)


def cameras(*yaws):
    return [Camera(yaw, 0.01, (50.0, 100.0), 100, 100) for yaw in yaws]


@pytest.mark.parametrize(
    ("yaws", "between"),
    [
        ((0.0, 90.0), (45.0, 135.0)),
        ((0.0, 270.0), (45.0, 135.0)),  # from behind a tree is its mirror image
        ((10.0, 40.0), (115.0,)),
        ((0.0, 45.0, 90.0, 135.0), ()),
        ((-20.0, 70.0), (115.0, 205.0)),
    ],
)
def test_it_looks_from_the_middle_of_wide_gaps(yaws, between):
    views = look_between(VOLUME, cameras(*yaws), loose=False)
    assert [view.camera.yaw for view in views] == pytest.approx(between)


def test_it_shows_all_of_the_volume():
    for view in look_between(VOLUME, cameras(0.0, 90.0), loose=False):
        area = view.camera.metres_per_pixel**2
        wide = Camera(view.camera.yaw, 0.01, (200.0, 300.0), 400, 400)
        assert view.alpha.sum() * area == pytest.approx(project_density(VOLUME, wide).sum() * 1e-4, rel=0.02)


def test_what_loose_photographs_agree_on_counts_more():
    exact, loose = (look_between(VOLUME, cameras(0.0, 90.0), loose=loose) for loose in (False, True))
    assert all(one.weight < other.weight <= 1.0 for one, other in zip(exact, loose, strict=True))
