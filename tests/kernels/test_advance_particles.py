import numpy as np
import pytest
import warp as wp
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree import device as devices
from flowtree.kernels.advance_particles import advance_particles
from flowtree.kernels.reference.advance_particles import advance_particles as advance_twin
from tests.flows import (
    DEVICES,
    chance_fields,
    chance_times,
    forces,
    particles,
    upload_fields,
    upload_times,
)


def advance(p, nearest, begin, fields, force, times, *, front, step, arrival, device):
    """Step 3 on the device: positions, velocities, states and last steps."""
    n = len(p.state)
    inputs = [devices.upload(a, wp.vec3, device) for a in (p.position, p.position, p.velocity)]
    inputs += [devices.upload(p.mass, float, device), devices.upload(p.state, int, device)]
    inputs += [devices.upload(nearest, int, device), devices.upload(begin, int, device)]
    inputs += [upload_fields(fields, device), force, upload_times(times, device), front, step, arrival, 3]
    out = [devices.zeros(n, kind, device) for kind in (wp.vec3, wp.vec3, int)]
    out.append(devices.upload(np.full(n, -1, np.int32), int, device))
    devices.launch(advance_particles, n, inputs, out, device=device, split_from=2)
    return [a.numpy() for a in out]


@pytest.mark.parametrize("device", DEVICES)
@settings(max_examples=10, deadline=None)
@given(seed=st.integers(0, 10_000), step=st.floats(0.005, 0.3), front=st.floats(0.0, 2.5))
def test_equals_its_twin(device, seed, step, front):
    p, rng = particles(seed, 20), np.random.default_rng(seed)
    nearest = rng.integers(-1, 20, 20).astype(np.int32)
    begin = rng.integers(2, 7, 20).astype(np.int32)
    fields, times = chance_fields(seed), chance_times(seed)
    fast = advance(
        p, nearest, begin, fields, forces(), times, front=front, step=step, arrival=0.4, device=device
    )
    slow = [np.zeros((20, 3)), np.zeros((20, 3)), np.zeros(20, int), np.full(20, -1)]
    advance_twin(
        0, p.position, p.position, p.velocity, p.mass, p.state, nearest, begin, fields, forces(), times,
        front, step, 0.4, 3, *slow,
    )  # fmt: skip
    # The field's direction is a normalised sum: where it almost vanishes, float32's error is magnified.
    for ours, exact in zip(fast[:2], slow[:2], strict=True):
        wrong = np.abs(ours - exact).max(axis=1)
        assert np.quantile(wrong, 0.9) < 1e-4
    for ours, exact in zip(fast[2:], slow[2:], strict=True):
        assert (ours == exact).mean() > 0.9  # arrival and departure are thresholds


def _follow(steps, way=0.4):
    """The twin alone, in float64: where one particle is after a way of the given time."""
    fields = chance_fields(4, size=2)  # one cell: bilinear, so smooth everywhere
    fields.corner[:] = [-3.0, -3.0]
    fields.cell[:] = [3.0, 4.0]
    fields.vectors[..., 1] -= 1.5  # far from zero
    fields.route[:] = [0.0, -1.0, 0.0]
    times = chance_times(4)
    times.time[:] = 1.0
    state = np.array([1])
    x, v = np.array([[0.3, 1.0, -0.2]]), np.zeros((1, 3))
    for _ in range(steps):
        out = [np.zeros((1, 3)), np.zeros((1, 3)), np.zeros(1, int), np.zeros(1)]
        force = forces(response=0.3, attraction=0.0)
        advance_twin(
            0, x, x, v, np.ones(1), state, np.array([-1]), np.zeros(1), fields, force, times, 1.0,
            way / steps, 0.01, 0, *out,
        )  # fmt: skip
        x, v = out[0], out[1]
    return np.concatenate([x[0], v[0]])


def test_the_step_is_of_fourth_order():
    exact = _follow(64)
    errors = [np.linalg.norm(_follow(steps) - exact) for steps in (2, 4, 8)]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert (orders >= 3.8).all(), orders


@pytest.mark.parametrize("device", DEVICES)
def test_a_heavy_particle_turns_later(device):
    p = particles(0, 2)
    p.position[:] = [0.2, 1.0, 0.1]
    p.velocity[:], p.state[:] = 0.0, 1
    p.mass[:] = [1.0, 1000.0]
    out = advance(
        p, np.full(2, -1, np.int32), np.zeros(2, np.int32), chance_fields(2), forces(inertia=0.5),
        chance_times(2), front=1.0, step=0.01, arrival=0.01, device=device,
    )  # fmt: skip
    light, heavy = np.linalg.norm(out[1], axis=1)
    assert 0 < heavy < 0.1 * light


@pytest.mark.parametrize("device", DEVICES)
@pytest.mark.parametrize("response", [1e-6, 1e-3, 10.0])
def test_no_response_is_too_quick_for_the_step(device, response):
    """Without its bound the rate would be a million steps', and the place not a number soon."""
    p, fields, times = particles(1, 30), chance_fields(1), chance_times(1)
    p.state[:] = 1
    for _ in range(30):
        out = advance(
            p, np.roll(np.arange(30), 1).astype(np.int32), np.zeros(30, np.int32), fields,
            forces(response=response, attraction=20.0), times, front=1.0, step=0.1, arrival=0.0,
            device=device,
        )  # fmt: skip
        p.position, p.velocity = out[0], out[1]
    assert np.isfinite(p.position).all()
    # A speed of at most 2 toward a direction of at most 21.
    assert np.abs(p.velocity).max() < 2 * 21


@pytest.mark.parametrize("device", DEVICES)
def test_a_lone_particle_reaches_unit_speed(device):
    """Nobody holds it back at the place where the step began."""
    p, fields = particles(0, 1), chance_fields(0)
    p.position[:], p.velocity[:], p.state[:] = [0.1, 1.7, 0.2], 0.0, 1
    fields.vectors[:], fields.pull = [0.0, -1.0], 0.0
    alone, now = np.full(1, -1, np.int32), np.zeros(1, np.int32)
    for _ in range(30):
        out = advance(
            p, alone, now, fields, forces(pace=0.0), chance_times(0), front=1.0, step=0.03, arrival=0.1,
            device=device,
        )  # fmt: skip
        p.position, p.velocity = out[0], out[1]
    assert np.allclose(p.velocity, [[0.0, -1.0, 0.0]], atol=1e-3)
