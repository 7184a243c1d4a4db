from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.errors import InputError
from flowtree.geometry.parent_array import main_child
from flowtree.wind.bind_joints import bind_joints
from tests.skeletons import random_skeleton
from tests.wind.skinning import pose


@settings(max_examples=25, deadline=None)
@given(
    seed=st.integers(0, 10_000),
    nodes=st.integers(1, 150),
    joints=st.integers(1, 60),
    thickness=st.floats(0, 1),
)
def test_the_armature_is_whole(seed, nodes, joints, thickness):
    skeleton = random_skeleton(seed, nodes, step_in_thickness=thickness)
    armature = bind_joints(skeleton, joints=joints)
    count = len(armature.parent)
    # The stem is never left without its joints.
    assert 1 <= count <= max(joints, 6)
    assert armature.parent[0] == -1
    assert (armature.parent[1:] < np.arange(1, count)).all()
    assert (armature.parent[1:] >= 0).all()
    above = np.maximum(skeleton.parent[armature.node], 0)
    np.testing.assert_array_equal(armature.points, skeleton.points[above])
    assert len(set(armature.node.tolist())) == count
    assert armature.joint.shape == armature.weight.shape == (nodes, 2)
    assert ((armature.joint >= 0) & (armature.joint < count)).all()
    assert (armature.weight >= 0).all()
    assert (armature.weight[:, 0] >= armature.weight[:, 1]).all()
    np.testing.assert_allclose(armature.weight.sum(axis=1), 1.0, atol=1e-6)
    assert (armature.joint[armature.weight == 0] == 0).all()
    assert armature.joint[0].tolist() == [0, 0]


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 10_000))
def test_a_branch_without_joints_follows_where_it_leaves(seed):
    skeleton = random_skeleton(seed, 120)
    armature = bind_joints(skeleton, joints=20)
    onward = main_child(skeleton.parent, skeleton.radius)
    head = np.arange(120)
    for node in range(1, 120):
        above = skeleton.parent[node]
        if onward[above] == node:
            head[node] = head[above]
    stiff = np.flatnonzero(~np.isin(head, armature.node))
    assert len(stiff)
    above = skeleton.parent[stiff]
    np.testing.assert_array_equal(armature.joint[stiff], armature.joint[above])
    np.testing.assert_array_equal(armature.weight[stiff], armature.weight[above])


@pytest.mark.parametrize("seed", range(4))
def test_limbs_bend_without_tearing(seed):
    skeleton = random_skeleton(seed, 400, stubborn=0.93)
    armature = bind_joints(skeleton, joints=60)
    rng = np.random.default_rng(seed)
    turns = rng.normal(0, np.radians(1.5), (len(armature.parent), 3))
    turns[0] = 0
    quaternions = np.concatenate([turns / 2, np.ones((len(turns), 1))], axis=1)
    quaternions /= np.linalg.norm(quaternions, axis=1, keepdims=True)
    posed = pose(armature, quaternions, skeleton.points, armature.joint, armature.weight)
    length = np.linalg.norm(
        np.diff([skeleton.points[1:], skeleton.points[skeleton.parent[1:]]], axis=0)[0], axis=1
    )
    after = np.linalg.norm(posed[1:] - posed[skeleton.parent[1:]], axis=1)
    assert np.linalg.norm(posed - skeleton.points, axis=1).max() > 0.1, "it moves"
    assert np.abs(after - length).max() < 0.02 * 10.0
    assert np.median(np.abs(after / length - 1)) < 0.01
    np.testing.assert_allclose(posed[0], 0, atol=1e-9)


def test_the_stem_comes_first_and_more_joints_reach_finer_branches():
    skeleton = random_skeleton(1, 300)
    few, many = (bind_joints(skeleton, joints=count) for count in (8, 80))
    assert len(few.parent) <= 8
    assert len(many.parent) <= 80
    np.testing.assert_array_equal(many.node[: len(few.node)], few.node)


def test_the_same_skeleton_gives_the_same_bytes():
    one, two = (bind_joints(random_skeleton(5, 200)) for _ in range(2))
    for name in ("parent", "points", "node", "joint", "weight"):
        assert getattr(one, name).tobytes() == getattr(two, name).tobytes()


def test_no_joint_is_refused():
    with pytest.raises(InputError, match="joints"):
        bind_joints(random_skeleton(0, 5), joints=0)
