"""The kernels against their float64 twins, on every device present."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sparse
import warp as wp
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree import device as devices
from flowtree.kernels import fit_depths as kernels
from flowtree.kernels.reference import fit_depths as twins
from tests.flows import DEVICES

LANES = kernels.LANES


def _entries(matrix):
    """Start, column and share of a sparse matrix's rows, as the kernels take them."""
    rows = sparse.csr_array(matrix)
    return [rows.indptr.astype(np.int32), rows.indices.astype(np.int32), rows.data.astype(np.float32)]


def _chance(seed, blocks=2, views=3, rays=4, voxels=11):
    """A matrix (views * rays, voxels) whose voxels are each met by some rays of every view, and its turn."""
    rng = np.random.default_rng(seed)
    shares = rng.random((views, rays, voxels)) * (rng.random((views, rays, voxels)) < 0.5)
    along = _entries(shares.reshape(views * rays, voxels))
    turned = np.zeros((voxels, views, views, rays))
    for view in range(views):
        turned[:, view, view] = shares[view].T
    across = _entries(turned.reshape(voxels * views, views * rays))

    def values(*shape):
        return rng.random((blocks, *shape, LANES)).astype(np.float32)

    return along, across, values


def _places(seed, voxels=11):
    """Some of them beyond the last ring of a profile."""
    return np.random.default_rng(seed).uniform(-4, 4, (voxels, 2)).astype(np.float32)


def _upload(values, device):
    kind = wp.int32 if values.dtype == np.int32 else wp.float32
    kinds = {LANES: kernels.Lanes, 2: wp.vec2}
    return devices.upload(values, kinds[values.shape[-1]] if values.ndim > 1 else kind, device)


def _both(kernel, twin, count, inputs, outputs, device):
    """The outputs of the kernel and of its twin."""
    given = [_upload(a, device) if isinstance(a, np.ndarray) else a for a in inputs]
    fast = [_upload(a, device) for a in outputs]
    devices.launch(kernel, count, given, fast, device=device, split_from=2)
    slow = [a.astype(np.float64) for a in outputs]
    twin(0, *inputs, *slow)
    return [a.numpy() for a in fast], slow


@pytest.mark.parametrize("device", DEVICES)
@settings(max_examples=10, deadline=None)
@given(seed=st.integers(0, 10_000), least=st.sampled_from([0.0, 0.3, 1.5]))
def test_equal_their_twins(device, seed, least):
    along, across, values = _chance(seed)
    density, depth = values(11), values(12)
    checks = [
        (kernels.sum_depths, twins.sum_depths, 24, [*along, density], [np.zeros_like(depth)]),
        (
            kernels.start_density,
            twins.start_density,
            22,
            [*across, depth, values(3), least],
            [np.zeros_like(density), np.zeros_like(density)],
        ),
        (
            kernels.step_density,
            twins.step_density,
            22,
            [*across, 3, depth - 0.5, values() - 0.5, np.round(values(11)), density],
            [values(11)],
        ),
        (
            kernels.pace_rows,
            twins.pace_rows,
            2,
            [depth, np.round(values(12)), values(12), values(12), values(12)],
            [np.round(3 * values()), 4 * values(), values(), values(), values(12)],
        ),
        (
            kernels.compare_depths,
            twins.compare_depths,
            24,
            [depth * np.round(values(12)), np.round(values(12)), values(12) * np.round(values(12))],
            [values(12)],
        ),
        (
            kernels.scale_density,
            twins.scale_density,
            22,
            [*across, 3, 2 * depth - 1, 0.7],
            [density * np.round(values(11))],
        ),
        (
            kernels.shape_density,
            twins.shape_density,
            22,
            [_places(seed), values() - 0.5, values() - 0.5, values(4), np.round(values(11))],
            [np.zeros_like(density)],
        ),
    ]
    for kernel, twin, count, inputs, outputs in checks:
        for ours, exact in zip(*_both(kernel, twin, count, inputs, outputs, device), strict=True):
            # A handful of float32 products of numbers around 1.
            assert np.allclose(ours, exact, rtol=1e-5, atol=1e-5), kernel.key


@pytest.mark.parametrize("device", DEVICES)
def test_a_step_that_made_it_worse_is_taken_back_and_the_next_one_stands(device):
    depth, none = np.ones((1, 3, LANES), np.float32), np.zeros((1, LANES), np.float32)
    sum_now, sum_before = 3 * depth, 1.5 * depth  # a residual of 2 now, of 0.5 before
    outputs = [none + 4, none + 0.75, none, none, 0 * depth]
    fast, _ = _both(
        kernels.pace_rows, twins.pace_rows, 1, [depth, depth, depth, sum_now, sum_before], outputs, device
    )
    age, best, plain, momentum, residual = fast
    assert (age == 0).all()
    assert (best == 0.75).all()
    assert (plain == 12).all()
    assert (momentum == -1).all()
    assert (residual == -0.5).all(), "that of the densities before"
    fast, _ = _both(
        kernels.pace_rows,
        twins.pace_rows,
        1,
        [depth, depth, depth, sum_now, sum_before],
        [age, best, none, none, 0 * depth],
        device,
    )
    age, best, plain, momentum, residual = fast
    assert (age == 1).all()
    assert (momentum == 0).all()
    assert (residual == -2).all(), "that of the last densities"


@pytest.mark.parametrize("device", DEVICES)
def test_rays_that_are_not_known_want_nothing(device):
    depth, none = np.ones((1, 3, LANES), np.float32), np.zeros((1, LANES), np.float32)
    known = np.zeros_like(depth)
    (ratio,), _ = _both(
        kernels.compare_depths, twins.compare_depths, 3, [depth, known, 5 * depth], [depth], device
    )
    assert (ratio == 0).all()
    outputs = [none + 1, none + 9, none + 7, none, depth]
    fast, _ = _both(
        kernels.pace_rows, twins.pace_rows, 1, [depth, known, depth, 5 * depth, 4 * depth], outputs, device
    )
    assert (fast[2] == 0).all()
    assert (fast[4] == 0).all()


@pytest.mark.parametrize("device", DEVICES)
def test_densities_never_become_negative(device):
    _, across, values = _chance(1)
    inputs = [*across, 3, values(12) - 5, values(), values(11) * 0 + 1, values(11)]
    (density,), _ = _both(kernels.step_density, twins.step_density, 22, inputs, [values(11)], device)
    assert (density == 0).all()
