"""Views that were placed wrongly come back to where all of them can show one tree."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from flowtree.density.project_density import project_density
from flowtree.model.camera import Camera
from flowtree.model.matte import Matte
from flowtree.model.placement import Estimate, Placement
from flowtree.model.volume import DensityVolume
from flowtree.pipeline.register_views import register_views

HEIGHT, PIXEL = 10.0, 0.04
FOOT, SIZE = (150.0, 270.0), (300, 300)


def tree(seed=0, side=48):
    """Clumps around a stem, from the ground to the top."""
    rng = np.random.default_rng(seed)
    voxel = HEIGHT / side
    place = (np.stack(np.meshgrid(*[np.arange(side)] * 3, indexing="ij"), axis=-1) + 0.5) * voxel
    place -= [HEIGHT / 2, 0, HEIGHT / 2]
    density = 3.0 * (np.hypot(place[..., 0], place[..., 2]) < 0.2)
    for _ in range(14):
        turn, up = rng.uniform(0, 2 * np.pi), rng.uniform(0.3, 0.93) * HEIGHT
        far = rng.uniform(0, 0.25) * HEIGHT
        middle = [far * np.cos(turn), up, far * np.sin(turn)]
        density += 0.6 * (np.linalg.norm(place - middle, axis=-1) < 0.07 * HEIGHT)
    corner = np.float32([-HEIGHT / 2, 0, -HEIGHT / 2])
    return DensityVolume(density.astype(np.float32), corner, voxel)


def look(side, **wrong):
    """A matte from this yaw, and a placement that takes it for another by so much."""
    true = Camera(side, PIXEL, FOOT, *SIZE, 2.0 * HEIGHT, 1.6)
    alpha = project_density(tree(), true)
    scale, turn = 1.0 + wrong.get("top", 0.0), np.radians(wrong.get("roll", 0.0))
    sine, cosine = scale * np.sin(turn), scale * np.cos(turn)
    about = np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    shift = np.array([[1.0, 0.0, FOOT[0]], [0.0, 1.0, FOOT[1]], [0.0, 0.0, 1.0]])
    warp = shift @ about @ np.linalg.inv(shift)
    camera = replace(true, yaw=side + wrong.get("yaw", 0.0))
    top = Estimate("top", FOOT[1] - HEIGHT / PIXEL, "pixels", "estimated", 10.0)
    return (
        Matte(alpha, np.zeros((*alpha.shape, 3), np.uint8), "automatic"),
        Placement(camera, warp, SIZE, estimates=(top,), open=("foot", "top", "roll", "yaw")),
    )


def register(*views):
    mattes, placements = zip(*views, strict=True)
    return register_views(mattes, placements, height=HEIGHT)


def size_of(placement):
    """How much larger than it is a placement takes its tree for, and its roll [degrees]."""
    across = placement.warp @ [FOOT[0], FOOT[1] - 100.0, 1.0] - placement.warp @ [*FOOT, 1.0]
    return np.hypot(*across[:2]) / 100.0 - 1.0, np.degrees(np.arctan2(across[0], -across[1]))


@pytest.mark.parametrize("wrong", [0.07, -0.07])
def test_a_view_of_another_scale_comes_to_that_of_the_others(wrong):
    first, second = register(look(0.0), look(90.0, top=wrong))
    assert abs(size_of(second)[0] - size_of(first)[0]) < abs(wrong) / 2
    found = {estimate.name: estimate for estimate in second.estimates}
    assert found["top"].origin == "estimated"
    assert 0.0 < found["top"].deviation < 15.0


def test_a_leaning_view_is_straightened():
    leaning = register(look(0.0), look(90.0, roll=3.0), look(45.0))[1]
    assert abs(size_of(leaning)[1]) < 2.0


def test_the_yaw_of_a_third_view_is_corrected():
    first, second, third = register(look(0.0), look(50.0, yaw=10.0), look(100.0))
    assert first.camera.yaw == 0.0, "only differences are seen"
    assert abs(second.camera.yaw - 50.0) < 5.0
    assert abs(third.camera.yaw - 100.0) < 3.0
    assert "yaw" in {estimate.name for estimate in second.estimates}


def test_two_views_fit_each_other_at_any_angle():
    first, second = register(look(0.0), look(90.0, yaw=10.0))
    assert (first.camera.yaw, second.camera.yaw) == (0.0, 100.0)


def test_what_was_given_stays():
    views = [look(0.0), look(90.0, top=0.07)]
    mattes = [matte for matte, _ in views]
    given = [replace(placement, open=()) for _, placement in views]
    assert register_views(mattes, given, height=HEIGHT) == tuple(given)
    half = [given[0], replace(views[1][1], open=("roll",))]
    after = register_views(mattes, half, height=HEIGHT)
    assert after[0] is half[0]
    assert size_of(after[1])[0] == pytest.approx(size_of(half[1])[0])
