import numpy as np
import pytest
import warp as wp
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree import device as devices
from flowtree.kernels.reference.time_flow import time_flow as time_flow_twin
from flowtree.kernels.time_flow import time_flow
from tests.flows import DEVICES, chance_fields, upload_fields


def _time(fields, start, step, limit, device):
    out = devices.zeros(len(start), float, device)
    inputs = [devices.upload(start, wp.vec3, device), upload_fields(fields, device), step, 0.03, limit]
    devices.launch(time_flow, len(start), inputs, [out], device=device, split_from=2)
    return out.numpy()


@pytest.mark.parametrize("device", DEVICES)
@settings(max_examples=5, deadline=None)
@given(seed=st.integers(0, 10_000))
def test_equals_its_twin(device, seed):
    fields = chance_fields(seed)
    start = np.random.default_rng(seed).uniform(-0.9, 0.9, (12, 3)).astype(np.float32) + np.float32([0, 1, 0])
    slow = np.zeros(12)
    time_flow_twin(0, start, fields, 0.03, 0.03, 25, slow)
    # Where the field parts, two paths that differ by a float32's 1e-7 part too; elsewhere errors stay small.
    wrong = np.abs(_time(fields, start, 0.03, 25, device) - slow)
    assert np.quantile(wrong, 0.75) < 1e-3


@pytest.mark.parametrize("device", DEVICES)
def test_a_straight_way_takes_its_length(device):
    fields = chance_fields(0)
    fields.basin = 100.0  # the foot alone attracts, but for a hundredth
    start = np.float32([[0, 1.5, 0], [0.6, 0.8, 0], [0, 0.01, 0], [0, 0, 0]])
    way = np.linalg.norm(start, axis=1)
    assert np.allclose(_time(fields, start, 0.01, 1000, device), way, atol=0.02)
