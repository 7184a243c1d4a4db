from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flowtree.geometry.smallest_ball import smallest_ball

CUBE = np.array(list(itertools.product([-1.0, 1.0], repeat=3))).T
TETRAHEDRON = CUBE[:, [0, 3, 5, 6]]


@pytest.mark.parametrize("corners", [CUBE, TETRAHEDRON], ids=["cube", "tetrahedron"])
def test_the_ball_of_regular_bodies(corners):
    middle, radius = smallest_ball(2.0 * corners + [[5.0], [-3.0], [1.0]])
    assert middle == pytest.approx([5.0, -3.0, 1.0], abs=0.02)
    assert radius == pytest.approx(2.0 * np.sqrt(3.0), rel=0.005)


def test_a_box_with_one_far_corner_has_a_smaller_ball_than_its_middle_says():
    points = np.concatenate([CUBE * [[1.0], [1.0], [0.1]], [[4.0], [0.0], [0.0]]], axis=1)
    middle, radius = smallest_ball(points)
    assert middle == pytest.approx([1.4, 0.0, 0.0], abs=0.05)
    assert radius < 0.98 * np.sqrt(np.sum((points - [[1.5], [0.0], [0.0]]) ** 2, axis=0).max())


def test_one_point_is_a_ball():
    middle, radius = smallest_ball(np.array([[1.0], [2.0], [3.0]]))
    assert middle.tolist() == [1.0, 2.0, 3.0]
    assert radius == 0.0


@given(st.integers(0, 2**32 - 1), st.integers(2, 60), st.floats(0.01, 1000.0))
def test_all_points_are_in_a_ball_no_larger_than_it_must_be(seed, count, size):
    points = size * np.random.default_rng(seed).normal(size=(3, count))
    middle, radius = smallest_ball(points)
    assert (np.linalg.norm(points - middle[:, None], axis=0) <= radius * (1 + 1e-12)).all()
    apart = np.linalg.norm(points[:, :, None] - points[:, None, :], axis=0).max()
    # Jung's theorem: no set of points needs more than this of its diameter.
    assert 0.5 * apart <= radius * (1 + 1e-12)
    assert radius <= 1.01 * np.sqrt(3.0 / 8.0) * apart
