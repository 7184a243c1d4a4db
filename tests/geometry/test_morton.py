import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.geometry.morton import morton_code, morton_order


@settings(max_examples=25, deadline=None)
@given(cells=st.lists(st.tuples(*[st.integers(0, 2**21 - 1)] * 3), min_size=1, max_size=20))
def test_codes_interleave_the_digits(cells):
    for cell, code in zip(cells, morton_code(np.array(cells)), strict=True):
        x, y, z = (format(value, "021b") for value in cell)
        assert code == int("".join(c + b + a for a, b, c in zip(x, y, z, strict=True)), 2)


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10_000), count=st.integers(0, 50), scale=st.floats(0, 1e3))
def test_an_order_holds_every_point_once(seed, count, scale):
    points = np.random.default_rng(seed).normal(size=(count, 3)) * scale
    assert sorted(morton_order(points).tolist()) == list(range(count))


def test_neighbours_on_the_curve_are_neighbours_in_space():
    points = np.random.default_rng(0).random((2000, 3))
    steps = np.linalg.norm(np.diff(points[morton_order(points)], axis=0), axis=1)
    assert steps.mean() < 0.25 * np.linalg.norm(np.diff(points, axis=0), axis=1).mean()


def test_equal_points_keep_their_order():
    assert morton_order(np.ones((5, 3))).tolist() == [0, 1, 2, 3, 4]
