from __future__ import annotations

import numpy as np

from flowtree.wind.bind_joints import bind_joints
from flowtree.wind.follow_joints import follow_joints
from tests.skeletons import random_skeleton
from tests.wind.test_weigh_wind import thin_out


def test_a_thinned_skeleton_keeps_its_joints():
    skeleton = random_skeleton(2, 200)
    keep = np.ones(200, bool)
    keep[~np.isin(np.arange(200), skeleton.parent)] = (
        np.arange(200)[~np.isin(np.arange(200), skeleton.parent)] % 2 == 0
    )
    keep[0] = True
    armature = bind_joints(skeleton, joints=40)
    followed = follow_joints(armature, skeleton, thin_out(skeleton, keep))
    assert followed.points is armature.points
    assert followed.parent is armature.parent
    np.testing.assert_array_equal(followed.joint, armature.joint[keep])
    np.testing.assert_array_equal(followed.weight, armature.weight[keep])


def test_of_nodes_at_one_place_the_first_counts():
    skeleton = random_skeleton(2, 3)
    skeleton.points[2] = skeleton.points[1]
    armature = bind_joints(skeleton, joints=40)
    followed = follow_joints(armature, skeleton, skeleton)
    np.testing.assert_array_equal(followed.joint, armature.joint[[0, 1, 1]])


def test_a_single_node():
    skeleton = random_skeleton(0, 1)
    armature = bind_joints(skeleton)
    assert follow_joints(armature, skeleton, random_skeleton(1, 5)).joint.tolist() == [[0, 0]] * 5
