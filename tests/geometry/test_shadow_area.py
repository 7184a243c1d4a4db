import numpy as np
import pytest

from flowtree.geometry.shadow_area import shadow_area


def test_a_ball_looks_as_large_as_its_great_circle():
    out = np.random.default_rng(0).normal(size=(200_000, 3))
    ball = 2.0 * out / np.linalg.norm(out, axis=1, keepdims=True)
    assert shadow_area(ball, 0.1) == pytest.approx(np.pi * 4.0, rel=0.08)


def test_points_in_one_place_are_one_cell_and_none_is_nothing():
    assert shadow_area(np.full((5, 3), 0.3), 0.5) == 0.25
    assert shadow_area(np.zeros((0, 3)), 0.5) == 0.0
