import numpy as np
import pytest
import warp as wp
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import cKDTree

from flowtree import device as devices
from flowtree.kernels.cell_list import assign_cells, bound_cells
from flowtree.kernels.find_nearest import find_nearest
from flowtree.kernels.reference.find_nearest import find_nearest as find_nearest_twin
from tests.flows import DEVICES, cell_grid, particles

RADIUS, REACH, GROWTH = 0.3, 0.05, 0.01


def search(p, grid, device):
    n, cells = len(p.state), grid.nx * grid.ny * grid.nz
    position, state = devices.upload(p.position, wp.vec3, device), devices.upload(p.state, int, device)
    key, index = devices.zeros(2 * n, int, device), devices.zeros(2 * n, int, device)
    begin = devices.zeros(cells + 1, int, device)
    devices.launch(assign_cells, n, [position, state, grid], [key, index], device=device)
    devices.sort_pairs(key, index, n)
    devices.launch(bound_cells, n + 1, [key, n, cells], [begin], device=device)
    out = [devices.zeros(n, int, device), devices.zeros(n, int, device)]
    inputs = [
        position,
        devices.upload(p.mass, float, device),
        state,
        index,
        begin,
        grid,
        RADIUS,
        REACH,
        GROWTH,
    ]
    devices.launch(find_nearest, n, inputs, out, device=device, split_from=2)
    return [a.numpy() for a in out]


@pytest.mark.parametrize("device", DEVICES)
@pytest.mark.parametrize("kind", ["even", "clustered", "coincident", "collinear"])
@settings(max_examples=6, deadline=None)
@given(seed=st.integers(0, 10_000), count=st.integers(1, 60))
def test_equals_everybody_against_everybody(device, kind, seed, count):
    p = particles(seed, count, kind)
    nearest, host = search(p, cell_grid(edge=RADIUS), device)
    slow = np.zeros((2, count), int)
    find_nearest_twin(
        0, p.position, p.mass, p.state, None, None, None, RADIUS, REACH, GROWTH, slow[0], slow[1]
    )
    # On a line of equal spacing two neighbours are equally near; which one float32 finds nearer is chance.
    place = p.position.astype(float)

    def far(i, j):
        return np.inf if j < 0 else np.linalg.norm(place[i] - place[j])

    for i in range(count):
        assert nearest[i] == slow[0][i] or abs(far(i, nearest[i]) - far(i, slow[0][i])) < 1e-6
        assert host[i] == slow[1][i] or kind == "collinear"


@pytest.mark.parametrize("device", DEVICES)
def test_equals_a_tree_search_on_many(device):
    p = particles(5, 3000)
    p.state[:] = 1
    nearest, _ = search(p, cell_grid(edge=RADIUS), device)
    distance, _ = cKDTree(p.position).query(p.position, k=2)
    found = np.linalg.norm(p.position - p.position[nearest], axis=1)
    # Squares of float32 differences: 1e-7 of coordinates around 1.
    assert np.allclose(found[nearest >= 0], distance[nearest >= 0, 1], atol=1e-6)
    assert (distance[nearest < 0, 1] > RADIUS - 1e-6).all()


@pytest.mark.parametrize("device", DEVICES)
@pytest.mark.parametrize("seed", range(3))
def test_hosts_are_heavier_and_never_run_in_a_circle(device, seed):
    p = particles(seed, 300, "clustered")
    _, host = search(p, cell_grid(edge=RADIUS), device)
    guest = np.flatnonzero(host >= 0)
    assert len(guest) > 50
    over = host[guest]
    heavier = (p.mass[over] > p.mass[guest]) | ((p.mass[over] == p.mass[guest]) & (over < guest))
    assert heavier.all()
    assert (p.state[over] == 1).all()
