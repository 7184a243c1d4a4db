import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.geometry.polylines import (
    arc_lengths,
    drop_repeats,
    nearest_on_segments,
    resample_polyline,
    smooth_polyline,
    subdivide_polyline,
)

numbers = st.floats(-100.0, 100.0, allow_nan=False)
lines = st.lists(st.tuples(numbers, numbers), min_size=2, max_size=12).map(lambda p: np.array(p))


@settings(max_examples=25, deadline=None)
@given(line=lines, spacing=st.floats(0.5, 50.0))
def test_resampling_keeps_the_ends_and_the_spacing(line, spacing):
    again = resample_polyline(line, spacing)
    assert np.allclose(again[[0, -1]], line[[0, -1]])
    assert np.linalg.norm(np.diff(again, axis=0), axis=1).max() <= spacing * (1 + 1e-6)


@settings(max_examples=25, deadline=None)
@given(line=lines, spacing=st.floats(0.5, 50.0))
def test_subdividing_moves_nothing(line, spacing):
    finer = subdivide_polyline(line, spacing)
    assert np.linalg.norm(np.diff(finer, axis=0), axis=1).max() <= spacing * (1 + 1e-6)
    assert {tuple(p) for p in line} <= {tuple(p) for p in finer}
    assert arc_lengths(finer)[-1] == pytest.approx(arc_lengths(line)[-1], rel=1e-9, abs=1e-9)


@settings(max_examples=25, deadline=None)
@given(line=lines, sigma=st.floats(0.0, 5.0))
def test_smoothing_keeps_the_ends(line, sigma):
    smooth = smooth_polyline(line, sigma)
    assert smooth.shape == line.shape
    assert np.array_equal(smooth[[0, -1]], line[[0, -1]])


def test_smoothing_keeps_a_straight_line_and_flattens_a_staircase():
    straight = np.stack([np.arange(30.0), 2.0 * np.arange(30.0)], axis=1)
    assert np.allclose(smooth_polyline(straight, 3.0), straight)
    stairs = np.stack([np.arange(41) // 2, (np.arange(41) + 1) // 2], axis=1).astype(float)
    smooth = smooth_polyline(stairs, 2.0)
    assert np.abs(smooth[8:-8, 0] - smooth[8:-8, 1]).max() < 0.51
    assert arc_lengths(smooth)[-1] < 0.8 * arc_lengths(stairs)[-1]


def test_repeats_go():
    assert len(drop_repeats([[0, 0], [0, 0], [1, 0], [1, 0]])) == 2


def test_nearest_point_is_exact():
    fraction, nearest = nearest_on_segments([[1.0, 3.0], [-5.0, 1.0]], [[0.0, 0.0]] * 2, [[4.0, 0.0]] * 2)
    assert fraction.tolist() == [0.25, 0.0]
    assert nearest.tolist() == [[1.0, 0.0], [0.0, 0.0]]
    fraction, nearest = nearest_on_segments([[1.0, 1.0]], [[2.0, 2.0]], [[2.0, 2.0]])
    assert nearest.tolist() == [[2.0, 2.0]]
