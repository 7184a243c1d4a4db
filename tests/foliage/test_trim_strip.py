"""A strip around an outline: it holds every texel, and no strip of as many bands is smaller."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog

from flowtree.foliage.trim_strip import trim_strip


def reach_of(there, width):
    columns = there.shape[1]
    away = (np.abs(np.arange(columns) + 0.5 - columns / 2) + 0.5) * (width / columns)
    reach = np.where(there, away, 0.0).max(axis=1)
    return 1.0 - (np.arange(len(there)) + 0.5) / len(there), reach


def area(along, half):
    return float(np.trapezoid(half, along))


def least_area(along, there, width):
    """By linear programming over all corners at once."""
    height, reach = reach_of(there, width)
    shares = np.array([np.interp(height, along, corner) for corner in np.eye(len(along))])
    price = np.array([np.trapezoid(corner, along) for corner in np.eye(len(along))])
    found = linprog(price, A_ub=-shares.T, b_ub=-reach, bounds=(0.005, 0.5 * width), method="highs")
    return float(found.fun)


@settings(max_examples=25, deadline=None)
@given(
    shape=st.tuples(st.integers(1, 50), st.integers(1, 30)),
    width=st.floats(0.05, 1.5),
    filled=st.floats(0.0, 1.0),
    seed=st.integers(0, 999),
)
def test_two_bands_are_the_least_of_all_places(shape, width, filled, seed):
    there = np.random.default_rng(seed).random(shape) < filled
    along, half = trim_strip(2, width, there)
    height, reach = reach_of(there, width)
    assert (np.interp(height, along, half) >= reach - 1e-9).all()
    assert 0.005 - 1e-12 <= half.min() <= half.max() <= 0.5 * width + 1e-12
    tried = [least_area(np.array([0.0, place, 1.0]), there, width) for place in np.linspace(0.2, 0.8, 7)]
    assert area(along, half) == pytest.approx(min(tried), abs=1e-9)


@pytest.mark.parametrize("bands", [3, 4])
def test_more_bands_are_the_least_at_even_places(bands):
    rows, columns = np.mgrid[0:64, 0:40]
    there = np.abs(columns - 19.5) < 4.0 + 14.0 * np.sin(np.pi * rows / 64.0)
    along, half = trim_strip(bands, 0.6, there)
    height, reach = reach_of(there, 0.6)
    assert np.allclose(along, np.linspace(0.0, 1.0, bands + 1))
    assert (np.interp(height, along, half) >= reach - 1e-9).all()
    assert area(along, half) == pytest.approx(least_area(along, there, 0.6), abs=1e-9)
