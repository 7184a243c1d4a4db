"""Ridges: scikit-image's, and one search for both signs."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from skimage.filters import sato

from flowtree.attraction.find_ridges import find_ridges


@settings(deadline=None, max_examples=20)
@given(
    rows=st.integers(2, 24),
    columns=st.integers(2, 24),
    sigmas=st.lists(st.floats(0.3, 6.0), min_size=1, max_size=3),
    seed=st.integers(0, 99),
)
def test_equals_scikit_image(rows, columns, sigmas, seed):
    values = np.random.default_rng(seed).normal(0.0, 1.0, (rows, columns)).astype(np.float32)
    for found, sign in zip(find_ridges(values, sigmas), (1, -1), strict=True):
        peer = sato(sign * values, sigmas=sigmas, black_ridges=False, mode="nearest")
        assert found.dtype == peer.dtype
        assert np.allclose(found, peer, rtol=1e-4, atol=1e-5)  # sums of float32 in another order


@pytest.mark.parametrize("sign", [1, -1])
def test_a_line_answers_in_its_own_sign_and_on_its_middle(sign):
    across = np.arange(41, dtype=np.float32)[None, :].repeat(30, axis=0) - 20.0
    line = (sign * np.exp(-(across**2) / 8.0)).astype(np.float32)
    found = find_ridges(line, [2.0])
    bright, dark = found if sign > 0 else found[::-1]
    assert (bright.argmax(axis=1) == 20).all()
    assert dark[:, 20].max() < 1e-6


def test_a_flat_picture_has_no_ridge():
    for found in find_ridges(np.full((12, 9), 0.4, np.float32), [1.0, 3.0]):
        assert found.max() < 1e-6
