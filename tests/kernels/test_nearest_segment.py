"""The kernel against its float64 twin, on every device present."""

from __future__ import annotations

import numpy as np
import pytest
import warp as wp
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree import device as devices
from flowtree.kernels.nearest_segment import nearest_segment
from flowtree.kernels.reference.nearest_segment import nearest_segment as nearest_twin
from tests.flows import DEVICES


def _boxes(start, end, run):
    at = np.arange(0, len(start), run)
    low = np.minimum.reduceat(np.minimum(start, end), at, axis=0)
    return low, np.maximum.reduceat(np.maximum(start, end), at, axis=0)


@pytest.mark.parametrize("device", DEVICES)
@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10_000), segments=st.integers(1, 40), run=st.integers(1, 9))
def test_equals_its_twin(device, seed, segments, run):
    rng = np.random.default_rng(seed)
    place, start = (rng.normal(size=(n, 2)).astype(np.float32) for n in (60, segments))
    along = rng.normal(size=(segments, 2)).round(rng.integers(0, 3)).astype(np.float32)
    square = (along**2).sum(axis=1)
    over = np.divide(1, square, out=np.zeros_like(square), where=square > 0)
    low, high = _boxes(start, start + along, run)
    values = [place, start, along, over, low, high]
    inputs = [devices.upload(a, wp.vec2 if a.ndim == 2 else wp.float32, device) for a in values]
    out = devices.zeros(60, wp.int32, device)
    devices.launch(nearest_segment, 60, [*inputs, run], [out], device=device, split_from=2)
    slow = np.zeros(60, np.int64)
    nearest_twin(0, *values, run, slow)
    gap = [
        place - start[k] - np.clip(((place - start[k]) * along[k]).sum(1) * over[k], 0, 1)[:, None] * along[k]
        for k in (out.numpy(), slow)
    ]
    far, exact = (np.linalg.norm(a, axis=1) for a in gap)
    # Segments that meet in a point are equally near to much of the plane: the distance is what must agree.
    assert np.allclose(far, exact, atol=1e-5)
