from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.geometry.rotation_matrices import rotation_matrices
from flowtree.geometry.spread_order import spread_order
from flowtree.levels.seen_area import seen_area
from flowtree.levels.simplify_leaf import simplify_leaf
from flowtree.levels.thin_leaves import thin_leaves
from tests.levels.trees import leaves_on
from tests.skeletons import random_skeleton


def _hidden(foliage) -> float:
    return seen_area(foliage.leaf, foliage.material) * float(np.sum(foliage.scale.astype(np.float64) ** 2))


@given(seed=st.integers(0, 1000), few=st.integers(1, 60), more=st.integers(0, 60))
@settings(deadline=None, max_examples=15)
def test_a_leaf_of_few_is_also_one_of_more_and_all_hide_as_much(seed, few, more):
    foliage = leaves_on(random_skeleton(seed, 40), 120, seed=seed)
    simple = simplify_leaf(foliage.leaf, foliage.material)
    order = spread_order(foliage.position, seed=seed)
    coarse = thin_leaves(foliage, order, few, simple)
    fine = thin_leaves(foliage, order, few + more, simple)
    assert len(coarse.position) == few
    assert {tuple(turn) for turn in coarse.rotation} <= {tuple(turn) for turn in fine.rotation}
    for thinned in (coarse, fine):
        assert _hidden(thinned) == pytest.approx(_hidden(foliage), rel=1e-4)


def test_a_leaf_grows_about_its_middle():
    foliage = leaves_on(random_skeleton(3, 40), 100)
    order = spread_order(foliage.position)
    simple = simplify_leaf(foliage.leaf, foliage.material)
    thinned = thin_leaves(foliage, order, 20, simple)

    def middles(some):
        leaf = some.leaf
        a, b, c = (leaf.positions[leaf.triangles[:, k]].astype(float) for k in range(3))
        area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
        middle = (area[:, None] * (a + b + c) / 3).sum(axis=0) / area.sum()
        return some.position + some.scale[:, None] * (rotation_matrices(some.rotation) @ middle)

    kept = np.sort(order[:20])
    assert np.allclose(middles(thinned), middles(foliage)[kept], atol=1e-5)
    assert np.array_equal(thinned.color, foliage.color[kept])
    assert np.array_equal(thinned.node, foliage.node[kept])


def test_all_leaves_of_their_own_shape_stay_as_they_are():
    foliage = leaves_on(random_skeleton(4, 40), 50)
    same = thin_leaves(foliage, spread_order(foliage.position), 50, foliage.leaf)
    assert np.array_equal(same.position, foliage.position)
    assert np.array_equal(same.scale, foliage.scale)
