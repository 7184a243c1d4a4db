"""The kernels against their twins, on every device present."""

from __future__ import annotations

import numpy as np
import pytest
import warp as wp
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree import device as devices
from flowtree.kernels import sweep_rings as kernels
from flowtree.kernels.reference import sweep_rings as twins
from tests.flows import DEVICES


def _chains(seed):
    """Some branches: centres with repeats, unit tangents among them reversals, and where each begins."""
    rng = np.random.default_rng(seed)
    lengths = rng.integers(1, 12, rng.integers(1, 6))
    count = int(lengths.sum())
    center = rng.normal(size=(count, 3)).round(rng.integers(0, 3))
    tangent = rng.normal(size=(count, 3)).round(rng.integers(0, 3)) + np.array([0.0, 1e-6, 0.0])
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    start = np.concatenate([[0], np.cumsum(lengths)]).astype(np.int32)
    return rng, center, tangent, start


def _up(values, kind, device):
    return devices.upload(np.asarray(values), kind, device)


@pytest.mark.parametrize("device", DEVICES)
@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10_000))
def test_frames_equal_their_twins(device, seed):
    _, center, tangent, start = _chains(seed)
    side = np.array([-0.1, -1.0, -0.1])
    inputs = [_up(a, wp.vec3d, device) for a in (center, tangent)]
    inputs += [_up(start, wp.int32, device), wp.vec3d(*side)]
    out = [devices.zeros(len(center), wp.vec3d, device) for _ in range(2)]
    devices.launch(kernels.transport_frames, len(start) - 1, inputs, out, device=device, split_from=2)
    slow = [np.zeros((len(center), 3)) for _ in range(2)]
    twins.transport_frames(0, center, tangent, start, side, *slow)
    for ours, exact in zip((a.numpy() for a in out), slow, strict=True):
        # Both are float64: only the order of a dot product's sums differs. Near a cut-off that can choose
        # another branch, in rare rings.
        assert (np.abs(ours - exact).max(axis=1) < 1e-9).mean() > 0.9
        assert np.allclose(np.linalg.norm(ours, axis=1), 1.0)


@pytest.mark.parametrize("device", DEVICES)
@settings(max_examples=15, deadline=None)
@given(seed=st.integers(0, 10_000))
def test_vertices_equal_their_twins(device, seed):
    rng, center, tangent, _ = _chains(seed)
    rings = len(center)
    one, two = rng.normal(size=(2, rings, 3))
    radius, slope = rng.uniform(0, 1, rings), rng.uniform(-2, 2, rings)
    slope[rng.random(rings) < 0.2] = -np.inf
    ring_of = np.sort(rng.integers(0, rings, rings + 3)).astype(np.int32)
    sides = rng.integers(2, 9, len(ring_of)).astype(np.int32)
    columns = sides + ~np.isneginf(slope)[ring_of]
    start = np.concatenate([[0], np.cumsum(columns)]).astype(np.int32)
    repeats = rng.integers(1, 4, len(ring_of)).astype(np.int32)
    uv_start = rng.random((len(ring_of), 2))
    values = [center, tangent, one, two, radius, slope, ring_of, sides, start, repeats, uv_start]
    kinds = [wp.vec3d] * 4 + [wp.float64] * 2 + [wp.int32] * 4 + [wp.vec2d]
    inputs = [_up(a, kind, device) for a, kind in zip(values, kinds, strict=True)]
    out = [devices.zeros(int(start[-1]), kind, device) for kind in (wp.vec3, wp.vec3, wp.vec2, wp.vec4)]
    devices.launch(kernels.place_vertices, len(ring_of), inputs, out, device=device, split_from=2)
    slow = [np.zeros(a.numpy().shape) for a in out]
    twins.place_vertices(0, *values, *slow)
    for ours, exact in zip((a.numpy() for a in out), slow, strict=True):
        assert np.allclose(ours, exact, rtol=1e-6, atol=1e-6)  # the outputs are float32
