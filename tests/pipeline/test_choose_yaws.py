"""Yaws: spread by default, and never two that show the same."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.errors import InputError
from flowtree.pipeline.choose_yaws import choose_yaws


def test_two_photos_stand_at_a_right_angle():
    assert choose_yaws(2) == (0.0, 90.0)


def test_one_photo_is_completed_by_its_mirror_image():
    assert choose_yaws(1) == (0.0, 90.0)
    assert choose_yaws(1, [30.0]) == (30.0, 120.0)


@given(count=st.integers(2, 60))
def test_defaults_pass_their_own_check(count):
    yaws = choose_yaws(count)
    assert choose_yaws(count, yaws) == yaws
    assert np.allclose(np.diff(yaws), 180.0 / count)


@settings(max_examples=25)
@given(yaws=st.lists(st.floats(-400, 400), min_size=2, max_size=5))
def test_what_passes_differs_and_sees_two_sides(yaws):
    try:
        chosen = choose_yaws(len(yaws), yaws)
    except InputError:
        return
    turns = np.radians(np.array(chosen))
    apart = np.abs(np.exp(1j * turns)[:, None] - np.exp(1j * turns)[None])
    assert (apart[~np.eye(len(yaws), dtype=bool)] > 1e-3).all()
    # A view and its opposite have the same doubled angle.
    doubled = np.exp(2j * turns)
    assert np.abs(doubled - doubled[0]).max() > 1e-3


@pytest.mark.parametrize(
    "yaws",
    [(0, 0), (0, 360), (90, -270), (0, 180), (45, 225), (0, 90, 90.2), (np.nan, 0), (0,), (0, 90, 45, 20)],
)
def test_views_that_show_the_same_are_refused(yaws):
    count = 2 if len(yaws) != 3 else 3
    with pytest.raises(InputError, match="yaw"):
        choose_yaws(count, yaws)


def test_opposite_views_are_welcome_beside_another():
    assert choose_yaws(3, (0, 180, 90)) == (0.0, 180.0, 90.0)


def test_no_photo_is_refused():
    with pytest.raises(InputError, match="photos"):
        choose_yaws(0)
