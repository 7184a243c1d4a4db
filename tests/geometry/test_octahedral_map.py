from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.geometry.octahedral_map import direction_to_square, level_axes, square_to_direction
from flowtree.geometry.projection import view_axes


@given(x=st.floats(-1, 1), y=st.floats(-1, 1))
@settings(deadline=None, max_examples=25)
def test_there_and_back(x, y):
    there = square_to_direction(np.array([[x, y]]))
    assert np.linalg.norm(there) == pytest.approx(1.0)
    assert there[0, 1] >= -1e-12
    assert np.allclose(direction_to_square(there), [[x, y]], atol=1e-9)


def test_the_middle_is_up_and_the_corners_are_the_level_axes():
    places = np.array([[0, 0], [1, 1], [-1, 1], [-1, -1], [1, -1]], float)
    wanted = [[0, 1, 0], [1, 0, 0], [0, 0, 1], [-1, 0, 0], [0, 0, -1]]
    assert np.allclose(square_to_direction(places), wanted, atol=1e-12)
    border = np.array([[1, t] for t in np.linspace(-1, 1, 9)])
    assert np.allclose(square_to_direction(border)[:, 1], 0.0, atol=1e-12)


@pytest.mark.parametrize("yaw", [0.0, 30.0, 90.0, 215.0])
def test_level_axes_are_those_of_a_camera(yaw):
    axes = view_axes(yaw)
    assert np.allclose(level_axes(axes[2]), np.stack(axes), atol=1e-12)


@given(seed=st.integers(0, 1000))
@settings(deadline=None, max_examples=20)
def test_level_axes_are_a_right_handed_frame(seed):
    out = np.random.default_rng(seed).normal(size=3)
    out /= np.linalg.norm(out)
    axes = level_axes(out)
    assert np.allclose(axes @ axes.T, np.eye(3), atol=1e-9)
    assert np.linalg.det(axes) == pytest.approx(1.0)
    assert abs(axes[0, 1]) < 1e-12
