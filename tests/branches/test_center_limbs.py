from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.branches.center_limbs import center_limbs
from flowtree.geometry.projection import to_plane
from flowtree.model.attractor import AttractorGraph
from tests.skeletons import random_skeleton, skeleton_of

YAWS = [0.0, 90.0]


def stem(lean=0.0, nodes=40):
    points = np.zeros((nodes, 3))
    points[:, 1] = np.linspace(0, 10, nodes)
    points[:, 0] = lean * points[:, 1]
    return skeleton_of(np.arange(-1, nodes - 1), points, np.random.default_rng(0))


def graph_of(skeleton, yaw):
    return AttractorGraph(skeleton.parent, to_plane(skeleton.points, yaw).astype(np.float32))


def swung(skeleton, size):
    """The stem swings around its line in both views, but for its foot and its tip."""
    up = skeleton.points[:, 1] / skeleton.points[-1, 1]
    aside = size * np.sin(np.pi * up) ** 2
    moved = skeleton.points + np.stack([aside, 0 * up, -0.7 * aside], axis=1)
    return replace(skeleton, points=moved.astype(np.float32))


@pytest.mark.parametrize("lean", [0.0, 0.3])
def test_a_trunk_on_the_graphs_stays(lean):
    true = stem(lean)
    made = center_limbs(true, [graph_of(true, yaw) for yaw in YAWS], YAWS)
    assert np.allclose(made.points, true.points, atol=1e-5)


@pytest.mark.parametrize("yaws", [[0.0, 90.0], [0.0, 70.0], [0.0, 45.0, 90.0]])
def test_a_trunk_beside_the_graphs_moves_onto_them(yaws):
    true = stem(0.1)
    off = swung(true, 0.08)
    made = center_limbs(off, [graph_of(true, yaw) for yaw in yaws], yaws)
    before, after = (np.linalg.norm(s.points - true.points, axis=1)[3:-6] for s in (off, made))
    assert before.max() > 0.09
    assert after.max() < 0.02
    assert np.array_equal(made.points[0], off.points[0])
    assert np.allclose(made.points[:, 1], off.points[:, 1])  # sideways only


def test_what_is_far_from_any_graph_keeps_its_shape():
    """It has not followed the graph; it goes along with the limb below, no farther than that moves."""
    true = stem()
    off = swung(true, 0.5)
    made = center_limbs(off, [graph_of(true, yaw) for yaw in YAWS], YAWS)
    moved = (made.points - off.points)[np.linalg.norm(off.points - true.points, axis=1) > 0.45]
    assert np.ptp(moved, axis=0).max() < 0.01
    assert np.linalg.norm(moved, axis=1).max() < 0.02 * 10 * 1.5


def test_what_grows_from_a_limb_moves_with_it():
    true = stem()
    off = swung(true, 0.08)
    fork = 20
    side = off.points[fork] + np.outer(np.arange(1, 6), [0.5, 0.2, 0]).astype(np.float32)
    crown = replace(
        off,
        parent=np.concatenate([off.parent, [fork, *range(40, 44)]]).astype(np.int32),
        points=np.concatenate([off.points, side]),
        radius=np.full(45, 0.01, np.float32),
        particles=np.concatenate([off.particles * 100, np.ones(5, np.int32)]),
        level=np.concatenate([off.level, np.ones(5, np.int32)]),
        twig=np.zeros(45, bool),
    )
    made = center_limbs(crown, [graph_of(true, yaw) for yaw in YAWS], YAWS)
    moved = made.points - crown.points
    assert np.linalg.norm(moved[fork]) > 0.08
    assert np.allclose(moved[40:], moved[fork], atol=0.02)


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 10_000), nodes=st.integers(2, 60), yaw=st.floats(0, 359))
def test_any_skeleton_and_graphs_give_a_finite_tree_at_the_same_foot(seed, nodes, yaw):
    skeleton, other = random_skeleton(seed, nodes), random_skeleton(seed + 1, nodes)
    made = center_limbs(skeleton, [graph_of(other, y) for y in (yaw, yaw + 80)], [yaw, yaw + 80])
    assert np.isfinite(made.points).all()
    assert np.array_equal(made.points[0], skeleton.points[0])
    assert np.array_equal(made.parent, skeleton.parent)
    reach = 0.02 * np.ptp(skeleton.points[:, 1]) * 3  # two views' shifts at an angle of 80 degrees
    assert np.linalg.norm(made.points - skeleton.points, axis=1).max() <= reach


def test_a_graph_without_a_segment_moves_nothing():
    skeleton = random_skeleton(1, 30)
    single = AttractorGraph(np.int32([-1]), np.zeros((1, 2), np.float32))
    made = center_limbs(skeleton, [single, single], YAWS)
    assert np.array_equal(made.points, skeleton.points)
