"""Simulated scribbles: on what is wrong, with the right label, the worst first."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks.likeness.draw_scribble import BACKGROUND, TREE, draw_scribble


def _truth():
    truth = np.zeros((200, 160), np.float32)
    truth[20:120, 30:130] = 1.0
    truth[120:190, 75:85] = 1.0
    return truth


@settings(deadline=None, max_examples=25)
@given(
    top=st.integers(0, 150),
    left=st.integers(0, 120),
    tall=st.integers(12, 60),
    wide=st.integers(12, 60),
    more=st.booleans(),
)
def test_a_stroke_lies_where_the_matte_is_wrong(top, left, tall, wide, more):
    truth = _truth()
    alpha = truth.copy()
    alpha[top : top + tall, left : left + wide] = float(more)
    nothing = np.zeros(truth.shape, np.uint8)
    drawn = draw_scribble(alpha, truth, nothing)
    if drawn is None:
        assert np.abs(alpha - truth).sum() < 400, "only what a person does not see may stay"
        return
    stroke = drawn != nothing
    assert set(np.unique(drawn)) == {0, BACKGROUND if more else TREE}
    assert (np.abs(alpha - truth)[stroke] > 0.5).mean() > 0.9
    assert stroke.sum() >= 1


def test_the_worst_place_comes_first_and_the_next_after_it_is_mended():
    truth = _truth()
    alpha = truth.copy()
    alpha[30:90, 40:120] = 0.0
    alpha[150:170, 10:40] = 1.0
    first = draw_scribble(alpha, truth, np.zeros(truth.shape, np.uint8))
    assert set(np.unique(first)) == {0, TREE}
    alpha[30:90, 40:120] = 1.0
    second = draw_scribble(alpha, truth, first)
    assert (second == TREE).sum() == (first == TREE).sum()
    assert (second == BACKGROUND)[150:170, 10:40].sum() == (second == BACKGROUND).sum() > 0


def test_labels_can_be_asked_for_and_a_right_matte_needs_none():
    truth = _truth()
    alpha = truth.copy()
    alpha[30:90, 40:120] = 0.0
    nothing = np.zeros(truth.shape, np.uint8)
    assert draw_scribble(alpha, truth, nothing, labels=(BACKGROUND,)) is None
    assert draw_scribble(truth, truth, nothing) is None


def test_a_stroke_runs_through_the_length_of_its_place():
    truth = np.zeros((200, 160), np.float32)
    truth[40:52, 20:140] = 1.0
    drawn = draw_scribble(np.zeros_like(truth), truth, np.zeros(truth.shape, np.uint8))
    rows, columns = np.nonzero(drawn)
    assert np.ptp(columns) > 90
    assert np.ptp(rows) < 8
