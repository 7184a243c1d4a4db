from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.errors import InputError
from flowtree.wind.bind_joints import bind_joints
from flowtree.wind.sway_joints import sway_joints
from flowtree.wind.weigh_wind import weigh_wind
from tests.skeletons import random_skeleton
from tests.wind.skinning import pose


def swaying(tree=0, nodes=300, **options):
    skeleton = random_skeleton(tree, nodes, stubborn=0.93)
    weights = weigh_wind(skeleton, height=10.0, seed=tree)
    armature = bind_joints(skeleton, joints=60)
    return skeleton, weights, armature, sway_joints(armature, weights, **options)


@settings(max_examples=15, deadline=None)
@given(
    seed=st.integers(0, 1000),
    nodes=st.integers(1, 100),
    seconds=st.floats(0.5, 60),
    strength=st.floats(0, 5),
)
def test_the_loop_closes_and_the_foot_rests(seed, nodes, seconds, strength):
    _, _, armature, sway = swaying(seed, nodes, seconds=seconds, strength=strength, seed=seed)
    assert sway.rotation.shape == (len(sway.times), len(armature.parent), 4)
    assert sway.rotation[0].tobytes() == sway.rotation[-1].tobytes()
    assert sway.times[0] == 0
    assert sway.times[-1] == np.float32(seconds)
    assert (np.diff(sway.times) > 0).all()
    np.testing.assert_allclose(np.linalg.norm(sway.rotation, axis=2), 1.0, atol=1e-6)
    assert (sway.rotation[:, 0] == [0, 0, 0, 1]).all()


def test_the_loop_has_no_break_in_its_speed():
    sway = swaying()[3]
    steps = np.linalg.norm(np.diff(sway.rotation.astype(float), axis=0), axis=2)
    around = np.concatenate([steps, steps[:1]])
    assert np.abs(np.diff(around, axis=0))[-1].max() <= 1.2 * np.abs(np.diff(steps, axis=0)).max()


def test_tips_move_most_the_stem_least_and_fast_parts_are_fine():
    skeleton, weights, armature, sway = swaying(2)
    keys = range(0, len(sway.times), 4)
    posed = np.array(
        [pose(armature, sway.rotation[k], skeleton.points, armature.joint, armature.weight) for k in keys]
    )
    moved = np.linalg.norm(posed - posed.mean(axis=0), axis=2).max(axis=0)
    stem = weights.depth == 0
    assert moved[stem].max() < moved[weights.depth == 2].max()
    assert moved[stem & (skeleton.points[:, 1] < 0.5)].max() < 0.01
    assert 0.02 < moved.max() < 1.5, "a gentle breeze for a tree of 10 m"
    tier = weights.depth[armature.node]
    wiggles = [
        np.abs(np.diff(np.sign(np.diff(sway.rotation[:, tier == k, 2].astype(float), axis=0)), axis=0))
        .sum(axis=0)
        .max()
        for k in (0, 2)
    ]
    assert wiggles[0] < wiggles[1]


def test_it_leans_with_the_wind():
    skeleton, _, armature, sway = swaying(1)
    top = np.argmax(skeleton.points[:, 1])
    lean = [
        pose(armature, turns, skeleton.points, armature.joint, armature.weight)[top, 0]
        for turns in sway.rotation
    ]
    assert np.mean(lean) > skeleton.points[top, 0]


def test_strength_scales_and_zero_rests():
    quiet, one, two = (swaying(strength=strength)[3].rotation for strength in (0.0, 1.0, 2.0))
    assert (quiet == [0, 0, 0, 1]).all()
    angle_one, angle_two = (
        2 * np.arccos(np.clip(turns[..., 3].astype(float), -1, 1)) for turns in (one, two)
    )
    large = angle_one > np.radians(1)
    np.testing.assert_allclose(angle_two[large], 2 * angle_one[large], rtol=0.02)


def test_the_same_seed_gives_the_same_bytes_and_another_other_gusts():
    one, two = swaying(nodes=100)[3], swaying(nodes=100)[3]
    assert one.rotation.tobytes() == two.rotation.tobytes()
    skeleton = random_skeleton(0, 100, stubborn=0.93)
    other = sway_joints(bind_joints(skeleton, joints=60), weigh_wind(skeleton, height=10.0), seed=9)
    assert other.rotation.tobytes() != one.rotation.tobytes()


@pytest.mark.parametrize("wrong", [{"strength": -1.0}, {"strength": np.nan}, {"seconds": 0.0}])
def test_bad_numbers_are_refused(wrong):
    with pytest.raises(InputError, match=next(iter(wrong))):
        swaying(**wrong)


def test_weights_of_another_skeleton_are_refused():
    armature = bind_joints(random_skeleton(0, 30))
    with pytest.raises(InputError, match="skeleton"):
        sway_joints(armature, weigh_wind(random_skeleton(0, 31), height=10.0))
