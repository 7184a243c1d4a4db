from __future__ import annotations

import dataclasses

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.wind.match_nodes import match_nodes
from tests.skeletons import random_skeleton
from tests.wind.test_weigh_wind import thin_out


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 1000), nodes=st.integers(1, 150))
def test_a_thinned_skeleton_finds_its_own_nodes(seed, nodes):
    skeleton = random_skeleton(seed, nodes)
    inner = np.isin(np.arange(nodes), skeleton.parent)
    keep = inner | (np.arange(nodes) % 3 > 0)
    keep[0] = True
    np.testing.assert_array_equal(match_nodes(skeleton, thin_out(skeleton, keep)), np.flatnonzero(keep))


def test_at_one_place_the_branching_order_tells_then_the_index():
    skeleton = random_skeleton(2, 3)
    skeleton.points[2] = skeleton.points[1]
    same = dataclasses.replace(skeleton, level=np.array([0, 0, 0], np.int32))
    assert match_nodes(same, same).tolist() == [0, 1, 1]
    told = dataclasses.replace(skeleton, level=np.array([0, 0, 1], np.int32))
    assert match_nodes(told, told).tolist() == [0, 1, 2]


def test_moved_nodes_find_the_nearest():
    skeleton = random_skeleton(2, 50)
    moved = dataclasses.replace(skeleton, points=skeleton.points + np.float32(0.001))
    assert (match_nodes(skeleton, moved) == np.arange(50)).all()
