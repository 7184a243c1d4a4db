"""The fields against their twin, through a kernel that only asks for them."""

import numpy as np
import pytest
import warp as wp
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree import device as devices
from flowtree.kernels.flow_fields import FlowFields, flow_direction, route_vector, view_vector
from flowtree.kernels.reference import flow_fields as twin
from tests.flows import DEVICES, chance_fields, upload_fields

wp.set_module_options({"enable_backward": False})


@wp.kernel
def ask(
    first: int,
    fields: FlowFields,
    at: wp.array[wp.vec3],
    view_out: wp.array[wp.vec2],
    route_out: wp.array[wp.vec3],
    flow_out: wp.array[wp.vec3],
):
    i = first + wp.tid()
    view_out[i] = view_vector(fields, fields.vectors.shape[0] - 1, at[i])
    route_out[i] = route_vector(fields, at[i])
    flow_out[i] = flow_direction(fields, at[i])


def _ask(fields, at, device):
    n = len(at)
    out = [devices.zeros(n, kind, device) for kind in (wp.vec2, wp.vec3, wp.vec3)]
    inputs = [upload_fields(fields, device), devices.upload(at, wp.vec3, device)]
    devices.launch(ask, n, inputs, out, device=device, split_from=2)
    return [a.numpy() for a in out]


@pytest.mark.parametrize("device", DEVICES)
@settings(max_examples=10, deadline=None)
@given(
    seed=st.integers(0, 10_000),
    yaws=st.lists(st.floats(-180, 180), min_size=1, max_size=3),
    closeness=st.sampled_from([0.0, 0.2, 0.5]),
)
def test_equals_its_twin(device, seed, yaws, closeness):
    fields = chance_fields(seed, yaws, closeness=closeness)
    # Beyond the box, too: there the border's value holds.
    at = np.random.default_rng(seed).uniform(-1.6, 2.4, (40, 3)).astype(np.float32)
    view, route, flow = _ask(fields, at, device)
    exact = at.astype(float)
    assert np.allclose(view, [twin.view_vector(fields, len(yaws) - 1, p) for p in exact], atol=1e-5)
    assert np.allclose(route, [twin.route_vector(fields, p) for p in exact], atol=1e-5)
    # Normalising a sum that almost vanishes magnifies float32's 1e-7 by the inverse of its length.
    wrong = np.abs(flow - [twin.flow_direction(fields, p) for p in exact]).max(axis=1)
    assert np.quantile(wrong, 0.9) < 1e-4
    assert wrong.max() < 0.05


@pytest.mark.parametrize("device", DEVICES)
def test_at_the_foot_and_below_the_ground_the_foot_alone_attracts(device):
    fields = chance_fields(1)
    at = np.float32([[0, -0.5, 0], [0.3, -0.2, -0.3], [0, 0, 0], [1e-4, 1e-4, 0]])
    _, _, flow = _ask(fields, at, device)
    length = np.maximum(np.linalg.norm(at, axis=1, keepdims=True), 1e-12)
    # Half a percent of the way that the fourth point lies inside the basin is still the field's.
    assert np.allclose(flow, -at / length, atol=5e-3)
