from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.geometry.parent_array import (
    child_count,
    depths,
    levels,
    main_child,
    parents_first,
    reach_to_tip,
    sum_before,
    sum_to_root,
)


def forests():
    """Parent arrays in any order: node k hangs on an earlier one of a random permutation, or is a root."""

    def build(seed, count):
        rng = np.random.default_rng(seed)
        parent, name = np.full(count, -1), rng.permutation(count)
        for k in range(1, count):
            if rng.random() < 0.9:
                parent[name[k]] = name[rng.integers(max(0, k - rng.integers(1, 20)), k)]
        return parent

    return st.builds(build, st.integers(0, 10_000), st.integers(1, 60))


def _way(parent, node):
    way = [node]
    while parent[way[-1]] >= 0:
        way.append(parent[way[-1]])
    return way


@settings(max_examples=25, deadline=None)
@given(parent=forests())
def test_each_equals_walking_the_tree(parent):
    n = len(parent)
    ways = [_way(parent, k) for k in range(n)]
    assert depths(parent).tolist() == [len(way) - 1 for way in ways]
    own = np.arange(n) + 1
    walked = np.zeros(n, int)
    for k, way in enumerate(ways):
        walked[way] += own[k]
    assert np.array_equal(sum_to_root(parent, own), walked)
    assert sum_before(parent, own).tolist() == [own[way[1:]].sum() for way in ways]
    children = [np.flatnonzero(parent == k) for k in range(n)]
    assert child_count(parent).tolist() == [len(c) for c in children]
    weight = own % 5
    expected = [min(c, key=lambda j: (-weight[j], j)) if len(c) else -1 for c in children]
    assert main_child(parent, weight).tolist() == expected


@settings(max_examples=25, deadline=None)
@given(parent=forests())
def test_parents_come_first_and_the_tree_stays(parent):
    order, moved = parents_first(parent)
    assert sorted(order.tolist()) == list(range(len(parent)))
    assert (moved < np.arange(len(parent))).all()
    for new, old in enumerate(order):
        assert parent[old] == (order[moved[new]] if moved[new] >= 0 else -1)


@settings(max_examples=25, deadline=None)
@given(parent=forests())
def test_levels_hold_every_node_once_and_parents_one_level_up(parent):
    found = levels(parent)
    assert sorted(np.concatenate(found).tolist()) == list(range(len(parent)))
    assert (parent[found[0]] == -1).all()
    for above, nodes in pairwise(found):
        assert np.isin(parent[nodes], above).all()


@pytest.mark.parametrize("parent", [[0], [1, 0], [-1, 2, 3, 1]])
def test_a_circle_is_an_error(parent):
    with pytest.raises(ValueError, match="circle"):
        depths(np.array(parent))


def test_the_way_to_the_farthest_tip():
    parent = np.array([-1, 0, 1, 1, 0])
    points = np.array([[0, 0, 0], [0, 1, 0], [0, 2, 0], [0, 1, 3], [0.5, 0, 0]], float)
    assert reach_to_tip(parent, points).tolist() == [4.0, 3.0, 0.0, 0.0, 0.0]
