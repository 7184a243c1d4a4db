from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.levels.rank_branches import rank_branches
from flowtree.levels.thin_skeleton import thin_skeleton
from tests.skeletons import random_skeleton


@given(seed=st.integers(0, 10_000), nodes=st.integers(1, 120), draw=st.integers(0, 5))
@settings(deadline=None, max_examples=25)
def test_a_branch_comes_after_the_one_it_leaves(seed, nodes, draw):
    skeleton = random_skeleton(seed, nodes, step_in_thickness=0.2)
    rank = rank_branches(skeleton, seed=draw)
    assert rank.parent[0] == -1
    assert rank.fork[0] == -1
    assert (rank.parent[1:] < np.arange(1, len(rank.parent))).all()
    assert np.array_equal(rank.branch[rank.fork[1:]], rank.parent[1:])
    assert rank.branch[0] == 0
    assert np.array_equal(np.unique(rank.branch), np.arange(len(rank.fork)))


@given(seed=st.integers(0, 10_000), nodes=st.integers(2, 120), share=st.floats(0, 1))
@settings(deadline=None, max_examples=25)
def test_what_is_left_is_a_tree_with_its_own_nodes(seed, nodes, share):
    skeleton = random_skeleton(seed, nodes)
    rank = rank_branches(skeleton)
    count = 1 + int(share * (len(rank.fork) - 1))
    thinned, moved = thin_skeleton(skeleton, rank, count, most=0.05)
    n = len(thinned.parent)
    assert thinned.parent[0] == -1
    assert ((thinned.parent[1:] >= 0) & (thinned.parent[1:] < np.arange(1, n))).all()
    stays = rank.branch < count
    assert n == stays.sum()
    assert np.array_equal(thinned.points, skeleton.points[stays])
    assert np.array_equal(thinned.points[moved[stays]], skeleton.points[stays])
    # What is gone belongs to the first node on its way to the root that is left.
    for node in np.flatnonzero(~stays):
        above = node
        while not stays[above]:
            above = skeleton.parent[above]
        assert np.array_equal(thinned.points[moved[node]], skeleton.points[above])


@given(seed=st.integers(0, 10_000), few=st.integers(1, 20), more=st.integers(0, 20))
@settings(deadline=None, max_examples=20)
def test_fewer_branches_are_among_more(seed, few, more):
    skeleton = random_skeleton(seed, 120, stubborn=0.6)
    rank = rank_branches(skeleton, seed=seed)
    coarse, _ = thin_skeleton(skeleton, rank, few, most=0.05)
    fine, _ = thin_skeleton(skeleton, rank, few + more, most=0.05)
    assert {tuple(point) for point in coarse.points} <= {tuple(point) for point in fine.points}


def _seen(skeleton):
    reach = skeleton.points[1:] - skeleton.points[skeleton.parent[1:]]
    return float(np.linalg.norm(reach, axis=1) @ skeleton.radius[1:])


def test_branches_become_thicker_by_what_is_lost():
    skeleton = random_skeleton(1, 600, stubborn=0.5)
    rank = rank_branches(skeleton)
    thinned, _ = thin_skeleton(skeleton, rank, len(rank.fork) // 2, most=10.0)
    assert _seen(thinned) == pytest.approx(_seen(skeleton), rel=1e-3)
    bounded, _ = thin_skeleton(skeleton, rank, len(rank.fork) // 2, most=1e-3)
    assert _seen(bounded) < _seen(thinned)
    assert (bounded.radius >= skeleton.radius[rank.branch < len(rank.fork) // 2]).all()
    # Order is kept: no branch outgrows the one it leaves where it did not before.
    parent = thinned.parent[1:]
    before = skeleton.radius[rank.branch < len(rank.fork) // 2]
    grew = (thinned.radius[1:] > thinned.radius[parent]) & (before[1:] <= before[parent])
    assert not grew.any()


def test_the_draw_follows_the_seed():
    skeleton = random_skeleton(2, 400, stubborn=0.5)
    one, again, other = (rank_branches(skeleton, seed=seed).branch for seed in (0, 0, 1))
    assert np.array_equal(one, again)
    assert not np.array_equal(one, other)
