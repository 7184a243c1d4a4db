import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.matting.fit_local_gaussian import fit_local_gaussian


def test_uniform_weights_give_the_colours_nearby():
    lab = np.zeros((80, 120, 3), np.float32)
    lab[:, :60] = (20, 5, -10)
    lab[:, 60:] = (70, -20, 30)
    near = fit_local_gaussian(lab, np.ones((80, 120)))
    assert near.mean[40, 10] == pytest.approx((20, 5, -10), abs=1.5)
    assert near.mean[40, 110] == pytest.approx((70, -20, 30), abs=1.5)
    # Across the edge the covariance lies along the line between both colours.
    assert near.covariance[40, 60, 0, 2] > 100
    assert near.distance(lab, 1.0)[40, 10] < 1.0


def test_without_weight_nearby_the_far_colours_count():
    rng = np.random.default_rng(0)
    lab = rng.normal((50, 0, 0), 2.0, (80, 120, 3)).astype(np.float32)
    weight = np.zeros((80, 120))
    weight[:, :8] = 1.0
    lab[:, :8] += (30, 0, 0)
    assert fit_local_gaussian(lab, weight).mean[40, 118] == pytest.approx((80, 0, 0), abs=1.5)


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), floor=st.floats(0.5, 6.0), spread=st.floats(0.1, 30.0))
def test_written_out_root_equals_linear_algebra(seed, floor, spread):
    rng = np.random.default_rng(seed)
    lab = rng.normal(50.0, spread, (24, 20, 3)).astype(np.float32)
    near = fit_local_gaussian(lab, rng.random((24, 20)))
    away = (lab - near.mean).astype(np.float64)
    full = near.floored(floor).astype(np.float64)
    slow = np.sqrt((away * np.linalg.solve(full, away[..., None])[..., 0]).sum(axis=2))
    # Single precision against double on covariances of condition up to some thousand.
    assert np.allclose(near.distance(lab, floor), slow, rtol=1e-2, atol=1e-3)
    assert np.allclose(near.log_determinant(floor), np.log(np.linalg.det(full)), atol=1e-2)
