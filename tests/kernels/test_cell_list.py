import numpy as np
import pytest
import warp as wp
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree import device as devices
from flowtree.kernels.cell_list import assign_cells, bound_cells
from flowtree.kernels.reference.cell_list import assign_cells as assign_twin
from flowtree.kernels.reference.cell_list import bound_cells as bound_twin
from tests.flows import DEVICES, cell_grid, particles


def sorted_list(p, grid, device):
    """Keys, the sorted list and where each cell begins, on the device."""
    n, cells = len(p.state), grid.nx * grid.ny * grid.nz
    key, index = devices.zeros(2 * n, int, device), devices.zeros(2 * n, int, device)
    begin = devices.zeros(cells + 1, int, device)
    inputs = [devices.upload(p.position, wp.vec3, device), devices.upload(p.state, int, device), grid]
    devices.launch(assign_cells, n, inputs, [key, index], device=device, split_from=2)
    unsorted = key.numpy()[:n].copy(), index.numpy()[:n].copy()
    devices.sort_pairs(key, index, n)
    devices.launch(bound_cells, n + 1, [key, n, cells], [begin], device=device, split_from=2)
    return unsorted, key, index, begin


# Everything here is whole numbers: twin and kernel agree exactly. A point that float32 puts on the other side
# of a cell's border would be the only excuse, and the random places do not lie so near to one.
@pytest.mark.parametrize("device", DEVICES)
@pytest.mark.parametrize("kind", ["even", "clustered", "coincident", "collinear"])
@settings(max_examples=6, deadline=None)
@given(seed=st.integers(0, 10_000), count=st.integers(1, 60))
def test_equals_its_twin(device, kind, seed, count):
    grid, p = cell_grid(), particles(seed, count, kind)
    (key, index), sorted_key, sorted_index, begin = sorted_list(p, grid, device)
    slow_key, slow_index = np.zeros(count, int), np.zeros(count, int)
    assign_twin(0, p.position, p.state, grid, slow_key, slow_index)
    assert np.array_equal(key, slow_key)
    assert np.array_equal(index, slow_index)
    assert np.array_equal(sorted_index.numpy()[:count], np.argsort(slow_key, kind="stable"))
    slow_begin = np.zeros(grid.nx * grid.ny * grid.nz + 1, int)
    bound_twin(0, sorted_key.numpy()[:count], count, len(slow_begin) - 1, slow_begin)
    assert np.array_equal(begin.numpy(), slow_begin)


@pytest.mark.parametrize("device", DEVICES)
def test_each_moving_particle_stands_in_its_cell_and_no_other_particle_does(device):
    grid, p = cell_grid(), particles(3, 200)
    (key, _), _, index, begin = sorted_list(p, grid, device)
    index, begin = index.numpy(), begin.numpy()
    listed = index[: begin[-1]]
    assert sorted(listed) == np.flatnonzero(p.state == 1).tolist()
    for cell in range(len(begin) - 1):
        assert (key[index[begin[cell] : begin[cell + 1]]] == cell).all()


@pytest.mark.parametrize("device", DEVICES)
def test_points_however_far_outside_belong_to_the_border(device):
    grid, p = cell_grid(), particles(0, 4)
    p.position = np.float32([[1e30, 1, 0], [-1e30, 1, 0], [0, 1e12, 0], [0, 1, -1e12]])
    p.state[:] = 1
    (key, _), *_ = sorted_list(p, grid, device)
    x, y, z = key % 7, key // 7 % 7, key // 49
    assert (x[:2].tolist(), y[2], z[3]) == ([6, 0], 6, 0)
