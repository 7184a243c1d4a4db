"""The plane through the axis: its rows and scales are those of an honest pinhole camera."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.geometry.central_plane import view_from_distance, view_from_focal

HEIGHTS = np.array([0.0, 0.1, 0.5, 0.9, 1.0])


def pinhole(places, *, distance, eye, pitch, focal):
    """(right, down) [pixels] from the picture's centre of places (x, height) in the plane."""
    forward = np.array([0.0, math.sin(pitch), math.cos(pitch)])
    up = np.array([0.0, math.cos(pitch), -math.sin(pitch)])
    rays = np.c_[places[:, 0], places[:, 1] - eye, np.full(len(places), distance)]
    depth = rays @ forward
    return np.c_[focal * rays[:, 0] / depth, -focal * (rays @ up) / depth]


@settings(max_examples=25, deadline=None)
@given(
    distance=st.floats(0.8, 50),
    eye=st.floats(0.01, 0.9),
    foot=st.floats(300, 1000),
    tall=st.floats(50, 900),
)
def test_rows_scales_and_homography_are_a_pinhole_cameras(distance, eye, foot, tall):
    view = view_from_distance(foot, foot - tall, distance=distance, eye=eye)
    assert view.row([0.0, 1.0]) == pytest.approx([foot, foot - tall])
    assert view.height(view.row(HEIGHTS)) == pytest.approx(HEIGHTS, abs=1e-6)
    places = np.c_[np.full(5, 0.3), HEIGHTS]
    seen = pinhole(places, distance=distance, eye=eye, pitch=view.pitch, focal=view.focal)
    seen[:, 1] += (
        foot - pinhole(np.zeros((1, 2)), distance=distance, eye=eye, pitch=view.pitch, focal=view.focal)[0, 1]
    )
    assert seen[:, 0] == pytest.approx(0.3 * view.scale(HEIGHTS))
    assert seen[:, 1] == pytest.approx(view.row(HEIGHTS))
    mapped = np.c_[places, np.ones(5)] @ view.homography(120.0).T
    assert mapped[:, :2] / mapped[:, 2:] == pytest.approx(seen + np.array([120.0, 0.0]))
    assert (mapped[:, 2] > 0).all()


@settings(max_examples=25, deadline=None)
@given(distance=st.floats(0.8, 20), eye=st.floats(0.01, 0.9), pitch=st.floats(-0.1, 0.4))
def test_the_focal_length_gives_the_distance_back(distance, eye, pitch):
    ends = pinhole(np.array([[0.0, 0.0], [0.0, 1.0]]), distance=distance, eye=eye, pitch=pitch, focal=900.0)
    view = view_from_focal(*(500.0 + ends[:, 1]), focal=900.0, centre=500.0, eye=eye)
    assert view.distance == pytest.approx(distance, rel=1e-6)
    assert view.pitch == pytest.approx(pitch, abs=1e-6)


def test_from_far_away_it_is_a_parallel_projection():
    far = view_from_distance(400.0, 100.0, distance=1e6, eye=0.1)
    flat = view_from_distance(400.0, 100.0, distance=math.inf, eye=0.1)
    assert far.row(HEIGHTS) == pytest.approx(flat.row(HEIGHTS), abs=1e-3)
    assert flat.scale(HEIGHTS) == pytest.approx(300.0)
    assert flat.height([400.0, 250.0]) == pytest.approx([0.0, 0.5])
    matrix = flat.homography(50.0) @ np.array([0.1, 0.5, 1.0])
    assert matrix[:2] / matrix[2] == pytest.approx([80.0, 250.0])
