"""Shares of lines that have wood near them."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks.likeness.wood_nearby import sample_lines, sample_wood, share_near
from tests.trees import hand_made_tree


def _line(*points, radius=0.1):
    at = np.array(points, float)
    return sample_lines(at[:-1], at[1:], np.full((len(at) - 1, 2), radius), 10.0)


@settings(deadline=None, max_examples=25)
@given(
    points=st.lists(
        st.tuples(*[st.floats(-5, 5)] * 3).filter(lambda point: any(abs(n) > 1e-6 for n in point)),
        min_size=2,
        max_size=6,
    ),
    reach=st.floats(0.05, 3),
)
def test_samples_keep_the_length_and_every_line_is_near_itself(points, reach):
    line = _line(*points)
    length = np.linalg.norm(np.diff(np.array(points), axis=0), axis=1).sum()
    assert line.length.sum() == pytest.approx(length)
    assert share_near(line, line, reach) == pytest.approx(1.0)


@settings(deadline=None, max_examples=25)
@given(reach=st.floats(0.05, 2), more=st.floats(0.0, 2), away=st.floats(0, 3))
def test_a_longer_reach_never_finds_less(reach, more, away):
    line, other = _line((0, 0, 0), (0, 8, 0)), _line((away, 2, 0), (away, 6, 0))
    assert share_near(line, other, reach + more) >= share_near(line, other, reach)


def test_half_a_line_beside_it_is_half():
    line, other = _line((0, 0), (0, 8)), _line((0.1, 0), (0.1, 4))
    assert share_near(line, other, 0.15) == pytest.approx(0.5, abs=0.03)
    assert share_near(other, line, 0.15) == pytest.approx(1.0)
    assert share_near(line, other, 0.05) == 0.0


def test_nothing_is_found_by_nothing():
    line = _line((0, 0), (0, 8))
    nothing = line.at_least(1.0)
    assert share_near(line, nothing, 1.0) == 0.0
    assert share_near(nothing, line, 1.0) == 1.0


def test_wood_in_a_view_is_the_projected_skeleton():
    tree = hand_made_tree()
    wood = sample_wood(tree.skeleton, tree.height, twigs=True)
    less = sample_wood(tree.skeleton, tree.height, twigs=False)
    assert less.length.sum() <= wood.length.sum()
    seen = wood.seen_from(90.0)
    np.testing.assert_allclose(seen.points[:, 1], wood.points[:, 1])
    np.testing.assert_allclose(seen.points[:, 0], -wood.points[:, 2], atol=1e-6)
