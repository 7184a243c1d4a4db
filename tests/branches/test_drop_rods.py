import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.branches.drop_rods import drop_rods
from flowtree.geometry.parent_array import sum_to_root
from flowtree.model.edit import PaintedEdit
from flowtree.model.guessed_view import GuessedView
from flowtree.model.matte import Matte
from tests.crowns import HEIGHT, camera_at, plane_of

CAMERAS = [camera_at(yaw) for yaw in (0.0, 90.0)]


def mattes_with(gap):
    """A wall of leaves above 2 m; the first view has a gap between two distances from the stem."""
    mattes = []
    for camera in CAMERAS:
        right, up = plane_of(camera)
        alpha = np.where((up > 2.0) & (np.abs(right) < 2.8), 0.7, 0.0)
        if camera.yaw == 0.0:
            alpha = np.where((right > gap[0]) & (right < gap[1]), 0.0, alpha)
        alpha = np.where((np.abs(right) < 0.1) & (up > 0), 1.0, alpha).astype(np.float32)
        mattes.append(Matte(alpha, np.zeros((*alpha.shape, 3), np.uint8), "trimap"))
    return mattes


def stem_with_branch(tip_particles, direction=(1.0, 0.0, 0.0)):
    """A stem up to 6 m; at 4 m a branch 2.4 m long leaves it."""
    stem = [(0.0, y, 0.0) for y in np.arange(0, 6.01, 0.2)]
    fork = 20
    branch = [tuple(np.array(stem[fork]) + 0.2 * k * np.array(direction)) for k in range(1, 13)]
    parent = np.array([-1, *range(len(stem) - 1), fork, *range(len(stem), len(stem) + 11)], np.int32)
    own = np.zeros(len(parent), np.int32)
    own[len(stem) - 1], own[-1] = 400, tip_particles
    return parent, np.array(stem + branch), own, np.zeros(len(parent), np.bool_)


def dropped(branches, mattes, longest=0.1, between=()):
    return drop_rods(branches, mattes, CAMERAS, height=HEIGHT, longest=longest, between=between)


def test_a_rod_through_a_gap_goes_and_its_particles_stay():
    branches = stem_with_branch(4)
    parent, points, own, limb = dropped(branches, mattes_with((0.5, 1.5)))
    assert len(parent) == 31
    assert own.sum() == branches[2].sum()
    assert own[20] == 4
    assert len(points) == len(limb) == 31


@pytest.mark.parametrize("case", ["no gap", "many particles", "a limb", "another direction"])
def test_what_the_mattes_show_or_many_took_stays(case):
    branches = stem_with_branch(
        300 if case == "many particles" else 4, (0, 0, 1.0) if case == "another direction" else (1.0, 0, 0)
    )
    if case == "a limb":
        branches[3][:] = True
    made = dropped(branches, mattes_with((0.5, 0.5) if case == "no gap" else (0.5, 1.5)))
    for one, other in zip(made, branches, strict=True):
        assert np.array_equal(one, other)


def test_an_unknown_gap_is_none():
    mattes = mattes_with((0.5, 1.5))
    right, _ = plane_of(CAMERAS[0])
    unknown = (right > 0.3) & (right < 1.7)
    mattes[0] = Matte(mattes[0].alpha, mattes[0].foreground, "trimap", unknown=unknown)
    assert len(dropped(stem_with_branch(4), mattes)[0]) == 43


@pytest.mark.parametrize(("alpha", "nodes"), [(0.05, 31), (0.6, 43)])
def test_a_twig_beyond_the_crown_that_no_photo_looks_at_goes(alpha, nodes):
    """Both photos show leaves there, the volume none or some: of a round crown it is beyond the rim."""
    camera = camera_at(45.0)
    right, _ = plane_of(camera)
    rim = GuessedView(np.where(np.abs(right) < 0.7, 0.7, alpha).astype(np.float32), camera, 1.0)
    branches = stem_with_branch(4, (np.sqrt(0.5), 0.0, -np.sqrt(0.5)))
    mattes = mattes_with((0.5, 0.5))
    assert len(dropped(branches, mattes)[0]) == 43
    assert len(dropped(branches, mattes, between=[rim])[0]) == nodes


@settings(max_examples=15, deadline=None)
@given(seed=st.integers(0, 10_000), longest=st.floats(0.001, 1.0))
def test_any_tree_stays_a_tree_and_loses_no_particle(seed, longest):
    random = np.random.default_rng(seed)
    count = 60
    parent = np.array([-1, *(int(random.integers(max(0, k - 5), k)) for k in range(1, count))], np.int32)
    points = np.zeros((count, 3))
    for k in range(1, count):
        points[k] = points[parent[k]] + random.normal((0, 0.15, 0), 0.15)
    own = random.integers(0, 5, count).astype(np.int32)
    own[-1] += 1
    made, places, kept, limb = dropped(
        (parent, points, own, random.random(count) < 0.2), mattes_with((0.2, 0.8)), longest
    )
    assert made[0] == -1
    assert ((made[1:] >= 0) & (made[1:] < np.arange(1, len(made)))).all()
    assert kept.sum() == own.sum()
    assert sum_to_root(made, kept)[0] == own.sum()
    assert len(places) == len(limb) == len(made)


def test_what_bears_something_painted_stays():
    branches = stem_with_branch(4)
    right, up = plane_of(CAMERAS[0])
    add = ((right > 2.0) & (up > 3.0)).astype(np.float32)
    edits = [PaintedEdit(add=add), PaintedEdit()]
    mattes = mattes_with((0.5, 1.5))
    made = drop_rods(branches, mattes, CAMERAS, height=HEIGHT, longest=0.1, edits=edits)
    assert np.array_equal(made[1], branches[1])
