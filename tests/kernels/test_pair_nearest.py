"""The paper's rule of joining against its twin, and what it promises."""

from __future__ import annotations

import numpy as np
import pytest
import warp as wp
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree import device as devices
from flowtree.kernels.pair_nearest import pair_nearest
from flowtree.kernels.reference.pair_nearest import pair_nearest as pair_twin
from tests.flows import DEVICES, particles


def pair(p, nearest, reach, device):
    inputs = [devices.upload(p.position, wp.vec3, device), devices.upload(p.mass, float, device)]
    inputs += [devices.upload(nearest, int, device), reach]
    out = [devices.zeros(len(nearest), int, device) for _ in range(2)]
    devices.launch(pair_nearest, len(nearest), inputs, out, device=device, split_from=2)
    return [a.numpy() for a in out]


def true_nearest(place):
    """(n,) by everybody against everybody; -1 for who is alone."""
    gap = np.linalg.norm(place[:, None].astype(float) - place[None], axis=2)
    np.fill_diagonal(gap, np.inf)
    return np.where(np.isfinite(gap.min(axis=1)), gap.argmin(axis=1), -1).astype(np.int32)


@pytest.mark.parametrize("device", DEVICES)
@pytest.mark.parametrize("kind", ["even", "clustered", "coincident", "collinear"])
@settings(max_examples=6, deadline=None)
@given(seed=st.integers(0, 10_000), count=st.integers(1, 60), reach=st.floats(1e-3, 1.0))
def test_equals_its_twin(device, kind, seed, count, reach):
    p, rng = particles(seed, count, kind), np.random.default_rng(seed)
    nearest = true_nearest(p.position)
    nearest[rng.random(count) < 0.1] = -1
    fast, slow = pair(p, nearest, reach, device), [np.zeros(count, int), np.zeros(count, int)]
    pair_twin(0, p.position, p.mass, nearest, reach, *slow)
    gap = np.linalg.norm(p.position - p.position[nearest], axis=1)
    clear = np.abs(gap - reach) > 1e-6  # a threshold, up to float32
    for ours, exact in zip(fast, slow, strict=True):
        assert (ours == exact)[clear].all()


@pytest.mark.parametrize("device", DEVICES)
@settings(max_examples=10, deadline=None)
@given(seed=st.integers(0, 10_000), count=st.integers(2, 200))
def test_nobody_takes_in_two_or_goes_over_itself(device, seed, count):
    p = particles(seed, count, "clustered")
    nearest = true_nearest(p.position)
    host, draws = pair(p, nearest, 0.1, device)
    guest = np.flatnonzero(host >= 0)
    assert (host[host[guest]] == -1).all()
    assert len(set(host[guest])) == len(guest)
    assert (p.mass[host[guest]] >= p.mass[guest]).all()
    assert (draws[host[guest]] == -1).all()
    assert np.array_equal(np.delete(draws, host[guest]), np.delete(nearest, host[guest]))
