import numpy as np
import pytest
import warp as wp
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree import device as devices
from flowtree.kernels.cell_list import assign_cells, bound_cells
from flowtree.kernels.find_nearest import find_nearest
from flowtree.kernels.join_particles import join_particles
from flowtree.kernels.reference.join_particles import join_particles as join_twin
from tests.flows import DEVICES, cell_grid, particles

RADIUS, REACH, GROWTH = 0.3, 0.06, 0.02


def join(p, device):
    """The kernel's outputs, and the hosts it was given."""
    grid, n = cell_grid(edge=RADIUS), len(p.state)
    cells = grid.nx * grid.ny * grid.nz
    position, velocity = (devices.upload(a, wp.vec3, device) for a in (p.position, p.velocity))
    mass, state = devices.upload(p.mass, float, device), devices.upload(p.state, int, device)
    key, index = devices.zeros(2 * n, int, device), devices.zeros(2 * n, int, device)
    begin = devices.zeros(cells + 1, int, device)
    nearest, host = devices.zeros(n, int, device), devices.zeros(n, int, device)
    devices.launch(assign_cells, n, [position, state, grid], [key, index], device=device)
    devices.sort_pairs(key, index, n)
    devices.launch(bound_cells, n + 1, [key, n, cells], [begin], device=device)
    inputs = [position, mass, state, index, begin, grid, RADIUS, REACH, GROWTH]
    devices.launch(find_nearest, n, inputs, [nearest, host], device=device)
    out = [devices.zeros(n, kind, device) for kind in (wp.vec3, wp.vec3, float, int)]
    out += [devices.upload(np.full(n, -1, np.int32), int, device) for _ in range(2)]
    inputs = [position, velocity, mass, state, host, index, begin, grid, REACH, GROWTH, 7]
    devices.launch(join_particles, n, inputs, out, device=device, split_from=2)
    return [a.numpy() for a in out], host.numpy()


@pytest.mark.parametrize("device", DEVICES)
@pytest.mark.parametrize("kind", ["even", "clustered", "coincident", "collinear"])
@settings(max_examples=6, deadline=None)
@given(seed=st.integers(0, 10_000), count=st.integers(1, 60))
def test_equals_its_twin(device, kind, seed, count):
    p = particles(seed, count, kind)
    fast, host = join(p, device)
    slow = [np.zeros((count, 3)), np.zeros((count, 3)), np.zeros(count), np.zeros(count, int)]
    slow += [np.full(count, -1), np.full(count, -1)]
    join_twin(0, p.position, p.velocity, p.mass, p.state, host, None, None, None, REACH, GROWTH, 7, *slow)
    # Means of up to 60 float32 values around 1.
    assert np.allclose(fast[0], slow[0], atol=1e-5)
    assert np.allclose(fast[1], slow[1], atol=1e-5)
    for ours, exact in zip(fast[2:], slow[2:], strict=True):
        assert np.array_equal(ours, exact)  # masses are whole numbers


@pytest.mark.parametrize("device", DEVICES)
@pytest.mark.parametrize("kind", ["clustered", "coincident"])
@settings(max_examples=8, deadline=None)
@given(seed=st.integers(0, 10_000), count=st.integers(2, 200))
def test_mass_and_momentum_are_kept(device, kind, seed, count):
    p = particles(seed, count, kind)
    (position, velocity, mass, state, joined, end), _ = join(p, device)
    before, after = p.state == 1, state == 1
    assert mass[after].sum() == p.mass[before].sum()
    for old, new in ((p.velocity, velocity), (p.position, position)):
        momentum = p.mass[before].astype(float) @ old[before]
        # Rounding of 200 float32 values, relative to the sum of their magnitudes.
        scale = p.mass[before] @ np.abs(old[before]) + 1.0
        assert (np.abs(mass[after].astype(float) @ new[after] - momentum) < 1e-5 * scale).all()
    gone = before & ~after
    assert (state[gone] == 2).all()
    assert (end[gone] == 7).all()
    assert after[joined[gone]].all(), "whoever took another in goes on"
    assert (joined[~gone] == -1).all()


@pytest.mark.parametrize("device", DEVICES)
def test_one_limb_takes_in_nearly_all_that_have_come_into_it_at_once(device):
    p = particles(0, 50)
    p.position = np.float32([0, 1, 0]) + np.random.default_rng(0).normal(0, 0.03, (50, 3)).astype(np.float32)
    p.mass[:], p.state[:] = 1.0, 1
    p.mass[17] = 500.0
    moving = []
    for _ in range(3):
        (p.position, p.velocity, p.mass, p.state, *_), _ = join(p, device)
        moving.append((p.state == 1).sum())
    assert moving[0] < 10, "the rest lay nearer, for its size, to another"
    assert moving[2] == 1
    assert (p.mass[17], p.state[17]) == (549.0, 1)
