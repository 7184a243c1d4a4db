import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.geometry.flatten_path import flatten_path


def only(data, tolerance=0.01):
    (line,) = flatten_path(data, tolerance)
    return line


def test_relative_and_absolute_say_the_same():
    absolute = only(
        "M10 10 L20 10 H30 V25 C30 30 40 30 40 25 S50 20 50 25 Q55 35 60 25 T70 25 A5 5 0 0 1 80 25 Z"
    )
    relative = only("m10,10 10 0h10v15c0 5 10 5 10 0s10-5 10 0q5 10 10 0t10 0a5 5 0 0110 0z")
    assert np.allclose(absolute, relative)
    assert np.array_equal(absolute[0], absolute[-1])


def test_moves_begin_new_lines_and_further_pairs_are_lines():
    first, second = flatten_path("M0 0 1 1 2 0 M5 5 l1 0", 0.1)
    assert first.tolist() == [[0, 0], [1, 1], [2, 0]]
    assert second.tolist() == [[5, 5], [6, 5]]


def test_drawing_goes_on_after_a_close():
    first, second = flatten_path("M1 1 h2 v2 z l5 5", 0.1)
    assert first[-1].tolist() == [1, 1]
    assert second.tolist() == [[1, 1], [6, 6]]


def test_arc_lies_on_its_circle():
    line = only("M1 0 A1 1 0 1 0 0 1")
    assert np.allclose(np.linalg.norm(line, axis=1), 1.0) or np.allclose(
        np.linalg.norm(line - [1, 1], axis=1), 1.0
    )
    assert np.linalg.norm(np.diff(line, axis=0), axis=1).sum() == pytest.approx(1.5 * np.pi, rel=0.01)


def test_radii_too_small_grow_to_a_half_circle():
    line = only("M0 0 A1 1 0 0 1 10 0")
    assert np.allclose(np.linalg.norm(line - [5, 0], axis=1), 5.0)


@settings(max_examples=25, deadline=None)
@given(points=st.lists(st.floats(-50, 50), min_size=8, max_size=8), tolerance=st.floats(0.02, 2.0))
def test_curve_stays_within_the_tolerance(points, tolerance):
    p = np.array(points).reshape(4, 2)
    data = "M{} {} C{} {} {} {} {} {}".format(*p.ravel())
    fine = flatten_path(data, 1e-4)
    coarse = flatten_path(data, tolerance)
    for a, b in zip(fine, coarse, strict=True):
        start, end = b[:-1], b[1:]
        along = end - start
        t = np.einsum("msd,sd->ms", a[:, None] - start, along) / np.maximum((along**2).sum(1), 1e-12)
        near = start + np.clip(t, 0, 1)[..., None] * along
        assert np.linalg.norm(a[:, None] - near, axis=2).min(axis=1).max() <= tolerance + 1e-3


@pytest.mark.parametrize(
    "data", ["L1 1", "M1", "M0 0 X", "M0 0 C1 1 2 2", "M1e999 0 L1 1", "M0 0 A1 1 0 2 0 1 1", "M 0 0 L 1 nan"]
)
def test_malformed_data_names_its_place(data):
    with pytest.raises(ValueError, match=r"character|starts"):
        flatten_path(data, 0.1)


@settings(max_examples=25, deadline=None)
@given(data=st.text("MmLlHhVvCcSsQqTtAaZz 0123456789.,-+e", max_size=40))
def test_random_data_either_parses_or_is_refused(data):
    try:
        lines = flatten_path(data, 0.1)
    except ValueError:
        return
    assert all(len(line) >= 2 and line.shape[1] == 2 for line in lines)
