"""Foreground colours: what was mixed is found again, in pictures of any size."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.matting.estimate_foreground import estimate_foreground


@settings(max_examples=20, deadline=None)
@given(height=st.integers(1, 70), width=st.integers(1, 70), seed=st.integers(0, 99))
def test_a_picture_without_background_is_its_own_foreground(height, width, seed):
    rgb = np.random.default_rng(seed).integers(0, 256, (height, width, 3)).astype(np.uint8)
    assert np.array_equal(estimate_foreground(rgb, np.ones((height, width), np.float32)), rgb)


@pytest.mark.parametrize("shape", [(60, 90), (301, 203), (97, 640)])
def test_means_of_smaller_pictures_are_as_good_as_full_ones(monkeypatch, shape):
    rng = np.random.default_rng(0)
    alpha = np.clip(0.5 + 3.0 * cv2.GaussianBlur(rng.normal(0.0, 1.0, shape), (0, 0), 3.0), 0.0, 1.0)
    alpha[:, : shape[1] // 3] = 0.0  # sky, far from any tree
    front = 90.0 + 60.0 * cv2.GaussianBlur(rng.normal(0.0, 1.0, (*shape, 3)), (0, 0), 2.0)
    back = np.linspace(150.0, 250.0, shape[1])[None, :, None] * np.ones((shape[0], 1, 3))
    rgb = np.rint(alpha[..., None] * front + (1.0 - alpha[..., None]) * back).astype(np.uint8)
    alpha = alpha.astype(np.float32)
    fast = estimate_foreground(rgb, alpha).astype(float)
    monkeypatch.setattr("flowtree.matting.estimate_foreground._FINE", 10_000)
    slow = estimate_foreground(rgb, alpha).astype(float)
    tree = alpha > 0.05
    assert np.abs(fast - slow)[tree].mean() < 0.5
    assert np.abs(fast - slow)[tree].max() < 10.0
    assert np.abs(fast - front)[tree].mean() < 0.75 * np.abs(rgb - front)[tree].mean()
