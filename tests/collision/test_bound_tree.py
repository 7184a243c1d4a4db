from __future__ import annotations

import dataclasses
import time

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.collision.bound_tree import bound_tree
from flowtree.errors import InputError
from flowtree.geometry.polylines import nearest_on_segments
from tests.skeletons import random_skeleton, skeleton_of, skeleton_of_stems
from tests.trees import hand_made_skeleton, scatter_leaves


def out_of_capsules(collision, points, radius):
    """How far balls around points stand out of the nearest capsule, (n,) [m]; below 0 they do not."""
    distance = [
        np.linalg.norm(points - nearest_on_segments(points, *ends)[1], axis=1) + radius - own
        for ends, own in zip(collision.capsule_ends, collision.capsule_radius, strict=True)
    ]
    return np.min(distance, axis=0)


def inside_hull(collision, points):
    hull = trimesh.Trimesh(collision.hull_positions, collision.hull_triangles, process=False)
    assert hull.is_watertight
    assert hull.is_winding_consistent
    assert hull.volume > 0
    height = (points[:, None] - hull.triangles_center) * hull.face_normals
    return height.sum(axis=2).max(axis=1) <= 1e-4


@settings(max_examples=25, deadline=None)
@given(
    seed=st.integers(0, 10_000), nodes=st.integers(2, 120), capsules=st.integers(1, 20), steps=st.floats(0, 1)
)
def test_capsules_are_few_and_real(seed, nodes, capsules, steps):
    skeleton = random_skeleton(seed, nodes, step_in_thickness=steps)
    collision = bound_tree(skeleton, capsules=capsules)
    assert 1 <= len(collision.capsule_radius) <= capsules
    assert collision.capsule_ends.shape == (len(collision.capsule_radius), 2, 3)
    assert (collision.capsule_radius > 0).all()
    assert (collision.capsule_ends[:, 0, 1] <= collision.capsule_ends[:, 1, 1]).all(), "the lower end first"
    assert 4 <= len(collision.hull_triangles) <= 64
    for values in (collision.capsule_ends, collision.capsule_radius, collision.hull_positions):
        assert np.isfinite(values).all()
    assert collision.capsule_radius.max() <= skeleton.radius.max() + 1e-6


@pytest.mark.parametrize("seed", range(8))
def test_thick_wood_lies_in_capsules_within_the_tolerance(seed):
    skeleton = random_skeleton(seed, 200, stubborn=0.95)
    collision = bound_tree(skeleton, capsules=400)
    foot = skeleton.radius[0]
    assert collision.thinnest == pytest.approx(0.2 * foot)
    thick = skeleton.radius >= collision.thinnest
    out = out_of_capsules(collision, skeleton.points[thick].astype(float), skeleton.radius[thick])
    assert np.abs(out).max() <= 0.4 * foot + 1e-6
    assert np.quantile(np.abs(out), 0.9) <= 0.15 * foot


@pytest.mark.parametrize("seed", range(8))
def test_as_much_wood_is_covered_as_the_capsules_suffice_for(seed):
    skeleton = random_skeleton(seed, 200, stubborn=0.95)
    few, many = (bound_tree(skeleton, capsules=count) for count in (8, 24))
    assert many.thinnest <= few.thinnest
    thick = skeleton.radius >= many.thinnest
    out = [
        out_of_capsules(each, skeleton.points[thick].astype(float), skeleton.radius[thick])
        for each in (few, many)
    ]
    assert out[1].max() <= out[0].max() + 1e-6


def test_a_straight_tapering_stem_is_its_capsules():
    stem = [[0, y, 0, 0.3 - 0.02 * y] for y in np.linspace(0, 10, 21)]
    skeleton = skeleton_of_stems([stem])
    collision = bound_tree(skeleton)
    np.testing.assert_allclose(collision.capsule_ends[:, :, [0, 2]], 0, atol=1e-6)
    np.testing.assert_allclose(collision.capsule_ends[0, 0], 0, atol=1e-6)
    assert (np.diff(collision.capsule_radius) < 0).all(), "from the foot up"
    out = out_of_capsules(collision, skeleton.points.astype(float), skeleton.radius)
    thick = skeleton.radius >= collision.thinnest
    assert np.abs(out[thick]).max() < 0.4 * 0.3


@pytest.mark.parametrize("count", [1, 5, 300])
def test_the_hull_holds_the_leaves(count):
    skeleton = hand_made_skeleton(6)
    foliage = scatter_leaves(skeleton, count)
    collision = bound_tree(skeleton, foliage)
    inside = inside_hull(collision, foliage.position.astype(float))
    assert inside.mean() >= 0.99
    assert len(collision.hull_triangles) <= 64


def test_a_bare_trees_hull_holds_its_branches_and_leaves_the_stem_free():
    skeleton = hand_made_skeleton(6)
    collision = bound_tree(skeleton)
    assert inside_hull(collision, skeleton.points[skeleton.level > 0].astype(float)).mean() >= 0.99
    assert not inside_hull(collision, skeleton.points[:1].astype(float)).any()


def test_a_few_stray_leaves_do_not_blow_the_hull_up():
    skeleton = hand_made_skeleton(6)
    foliage = scatter_leaves(skeleton, 2000)
    near = bound_tree(skeleton, foliage)
    position = foliage.position.copy()
    position[:3] *= 5
    stray = bound_tree(skeleton, dataclasses.replace(foliage, position=position))
    sizes = [np.ptp(each.hull_positions, axis=0).max() for each in (near, stray)]
    assert inside_hull(stray, position.astype(float)).mean() >= 0.99
    assert sizes[1] < 6 * sizes[0]


def test_without_a_hull_there_is_none_and_the_same_tree_gives_the_same_bytes():
    skeleton = random_skeleton(3, 100)
    assert len(bound_tree(skeleton, hull=False).hull_triangles) == 0
    one, two = bound_tree(skeleton), bound_tree(skeleton)
    for name in ("capsule_ends", "capsule_radius", "hull_positions", "hull_triangles"):
        assert getattr(one, name).tobytes() == getattr(two, name).tobytes()


def test_a_finely_divided_stem_takes_no_longer():
    up = np.linspace(0, 10, 6000)
    stem = np.stack([0.3 * np.sin(up), up, np.zeros(6000), 0.3 - 0.02 * up], axis=1)
    skeleton = skeleton_of(np.arange(-1, 5999), stem[:, :3], np.random.default_rng(0))
    skeleton = dataclasses.replace(skeleton, radius=stem[:, 3].astype(np.float32))
    begin = time.process_time()
    collision = bound_tree(skeleton)
    assert time.process_time() - begin < 5.0  # trying every split takes minutes
    out = out_of_capsules(collision, skeleton.points[::50].astype(float), skeleton.radius[::50])
    assert out.max() < 0.4 * 0.3


def test_bad_input_is_refused():
    with pytest.raises(InputError, match="capsules"):
        bound_tree(random_skeleton(0, 10), capsules=0)
    with pytest.raises(InputError, match="two nodes"):
        bound_tree(random_skeleton(0, 1))
