import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.matting.rate_likeness import Window, rate_likeness


@pytest.mark.parametrize("count", [1, 3])
def test_a_wide_window_is_one_gaussian(count):
    rng = np.random.default_rng(1)
    features = rng.normal(5.0, 2.0, (32, 32, count)).astype(np.float32)
    rated = rate_likeness(features, np.ones((32, 32), np.float32), [Window(1e4, 1e4, 1.0)], noise=0.5)
    # The moments are those of area averages at half the size: of products, so that none is lost.
    flat = features.reshape(-1, count).astype(np.float64)
    spread = np.cov(flat.T, bias=True).reshape(count, count) + 0.25 * np.eye(count)
    away = flat - flat.mean(axis=0)
    exact = -0.5 * (away @ np.linalg.inv(spread) * away).sum(axis=1) - 0.5 * np.linalg.slogdet(spread)[1]
    assert np.abs(rated.ravel() - exact).max() < 0.05


def test_rows_tell_what_lies_behind():
    features = np.zeros((40, 60, 1), np.float32)
    features[20:] = 10.0
    weight = np.zeros((40, 60), np.float32)
    weight[:, :6] = weight[:, -6:] = 1.0  # only the borders are known
    rated = rate_likeness(features, weight, [Window(30.0, 1.0, 1.0)], noise=1.0)
    swapped = rate_likeness(features[::-1], weight, [Window(30.0, 1.0, 1.0)], noise=1.0)
    assert np.allclose(rated[::-1], swapped, atol=1e-4)
    wrong = np.where(features[..., 0] > 5.0, 0.0, 10.0)[..., None].astype(np.float32)
    mixed = np.where(weight[..., None] > 0, features, wrong)
    assert rate_likeness(mixed, weight, [Window(30.0, 1.0, 1.0)], noise=1.0)[5, 30] < rated[5, 30] - 10.0


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), height=st.integers(1, 20), width=st.integers(1, 20))
def test_always_finite(seed, height, width):
    rng = np.random.default_rng(seed)
    features = rng.choice([0.0, 50.0], (height, width, 3)).astype(np.float32)
    weight = rng.integers(0, 2, (height, width)).astype(np.float32)
    rated = rate_likeness(features, weight, [Window(2.0, 3.0, 1.0), Window(9.0, 1.0, 0.1)], noise=1.0)
    assert rated.shape == (height, width)
    assert np.isfinite(rated).all()
