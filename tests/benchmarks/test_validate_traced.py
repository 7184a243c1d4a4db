"""What a right result is: every way to lose, keep or misplace a particle is found."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks.validate_traced import compare_traced, find_faults
from benchmarks.workload import Traced


def _traced(joined: list[int], end: list[int], **other: int) -> Traced:
    arrived = other.get("arrived", joined.count(-1))
    steps = other.get("particle_steps", sum(end) + len(end))
    return Traced(np.array(joined, np.int32), np.array(end, np.int32), arrived, steps, None)


_RIGHT = ([2, -1, 3, -1], [0, 9, 4, 9])  # 0 joins 2, that joins 3


def test_right_results_have_no_fault():
    assert find_faults(_traced(*_RIGHT), 4) == []
    assert find_faults(_traced([], []), 0) == []
    assert find_faults(_traced([-1, 0], [5, 5]), 2) == [], (
        "a host may arrive in the step that it takes one in"
    )


@pytest.mark.parametrize(
    ("traced", "words"),
    [
        (_traced([2, -1, 3, -1], [0, 9, 4, -1]), "never ended"),
        (_traced([2, -1, 3, 9], [0, 9, 4, 9]), "that there are not"),
        (_traced([2, -1, 3, -2], [0, 9, 4, 9]), "that there are not"),
        (_traced([2, -1, 3, -1], [4, 9, 4, 9]), "had ended"),
        (_traced([2, -1, 3, -1], [0, 9, 4, 3]), "had ended"),
        (_traced([1, 0, -1], [4, 5, 9]), "had ended"),
        (_traced(*_RIGHT, arrived=3), "arrived"),
        (_traced(*_RIGHT, particle_steps=27), "particle steps"),
        (_traced([-1], [3]), "not 4 particles"),
    ],
)
def test_faults_are_found(traced, words):
    count = 3 if len(traced.joined) == 3 else 4
    faults = find_faults(traced, count)
    assert any(words in fault for fault in faults), faults


@settings(deadline=None, max_examples=25)
@given(st.data())
def test_any_forest_keeps_its_mass_and_agrees_with_itself(draw):
    count = draw.draw(st.integers(1, 40))
    end = np.sort(draw.draw(st.lists(st.integers(0, 9), min_size=count, max_size=count)))
    joined = []
    for i in range(count):
        later = np.flatnonzero(end > end[i])
        host = draw.draw(st.sampled_from([-1, *later.tolist()]))
        joined.append(host)
    traced = _traced(joined, end.tolist())
    assert find_faults(traced, count) == []
    agreement = compare_traced(traced, traced)
    assert agreement == (1.0, 1.0, 0, 0.0, True)
    assert "100.00%" in str(agreement)


def test_other_merges_are_not_the_same_result():
    count = 1000
    known = _traced([-1] * 10 + [0] * (count - 10), [100] * 10 + [50] * (count - 10))
    assert compare_traced(known, known).holds
    for change in (
        {"joined": np.where(np.arange(count) > count // 2, 1, known.joined)},
        {"arrived": 30},
        {"particle_steps": known.particle_steps + 200},
        {"end_step": np.where(np.arange(count) > 990, 3, known.end_step)},
    ):
        assert not compare_traced(dataclasses.replace(known, **change), known).holds, change
    assert not compare_traced(_traced([-1], [3]), known).holds
