from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.geometry.spread_order import spread_order


@given(count=st.integers(0, 200), seed=st.integers(0, 100))
@settings(deadline=None, max_examples=25)
def test_it_is_an_order_of_all_points(count, seed):
    points = np.random.default_rng(seed).normal(size=(count, 3))
    assert np.array_equal(np.sort(spread_order(points, seed=seed)), np.arange(count))


def test_a_beginning_is_spread_as_the_whole():
    rng = np.random.default_rng(1)
    dense, sparse = rng.random((3000, 3)), rng.random((1000, 3)) + np.array([2.0, 0.0, 0.0])
    order = spread_order(np.concatenate([dense, sparse]))
    for count in (40, 200, 1000):
        share = (order[:count] < 3000).mean()
        assert abs(share - 0.75) < 2.0 / np.sqrt(count) * 0.3
    # Nearest neighbours of a random choice of 500 would lie nearer to each other.
    chosen = np.concatenate([dense, sparse])[order[:500]]
    random = np.concatenate([dense, sparse])[rng.permutation(4000)[:500]]

    def nearest(points):
        apart = np.linalg.norm(points[:, None] - points[None], axis=2) + np.eye(len(points)) * 9
        return apart.min(axis=1).mean()

    assert nearest(chosen) > 1.05 * nearest(random)


def test_seeds_begin_elsewhere():
    points = np.random.default_rng(2).random((64, 3))
    assert not np.array_equal(spread_order(points, seed=0)[:8], spread_order(points, seed=1)[:8])
    assert np.array_equal(spread_order(points, seed=5), spread_order(points, seed=5))
