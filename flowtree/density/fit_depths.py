"""The least-squares densities of a stack of height slices (Particle Flows, section 5)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import scipy.sparse as sparse
import warp as wp
from numpy.typing import NDArray

from flowtree import device as devices
from flowtree.kernels import fit_depths as kernels

_SPLIT_FROM = 128  # an index is hundreds of products
_LOOK = 5  # rounds between two looks at the residual
_STALL = 0.03  # of the tolerance: a residual that falls by less between two looks has reached its least
_LEAST_LENGTH = 0.1  # voxels; a ray that grazes less weighs no more

_Floats = NDArray[np.float32]


def fit_depths(
    shares: Sequence[sparse.csr_array],
    depths: Sequence[NDArray[np.floating[Any]]],
    *,
    least: float,
    iterations: int,
    tolerance: float,
    device: str,
) -> _Floats:
    """Finds densities >= 0 that add up to the views' depths, height by height.

    The start is the product of the views' depths at each voxel, scaled to the depth that the height holds.
    From there projected gradient steps (simultaneous iterative reconstruction: residuals over path lengths
    go back along their rays) with Nesterov's momentum (Beck and Teboulle 2009) lower the sum of the rays'
    squared residuals, each over the ray's length through voxels that may be filled. Momentum begins anew, for
    each height by itself, whenever it made the residual larger (O'Donoghue and Candès 2015), and that step is
    taken back: the residual of the result falls with every round.

    The relative residual is ``|A x - d| / |d|`` over all rays, x the densities and d the depths. The rounds
    end when it is at most ``tolerance``. Views that contradict each other leave some of it in any case: then
    they end when it falls so slowly that what is left to gain is less than ``tolerance``. Or they end after
    ``iterations``.

    Args:
        shares: one a view, (columns, voxels): the share of a voxel's matter that each ray meets; a voxel's
            shares sum to 1.
        depths: one a view, (columns, rows), optical depth along each ray of each height.
        least: depth that every view must show of a voxel that may be filled.
        iterations: rounds at most.
        tolerance: relative residual at which the rounds end.
        device: to run on.

    Returns: (blocks, voxels, lanes) float32, heights in runs of `kernels.LANES`: the depth of each voxel, that
        is its density times its edge; zeros above the last row.
    """
    system = _upload(shares, depths, device)
    blocks, rays, voxels, views = system.blocks, system.rays, system.voxels, len(shares)

    def grid(columns: int) -> Any:
        return devices.empty((blocks, columns), kernels.Lanes, device)

    def launch(kernel: Any, count: int, inputs: list[Any], outputs: list[Any], split: int) -> None:
        devices.launch(kernel, count, inputs, outputs, device=device, split_from=split)

    def project(density: Any, out: Any) -> None:
        launch(kernels.sum_depths, blocks * rays, [*system.along, density], [out], _SPLIT_FROM)

    filled, last, now = (grid(voxels) for _ in range(3))
    residual, sum_last, sum_now = (grid(rays) for _ in range(3))
    wanted = _held(system.depth, views)  # (views, blocks, lanes)
    factor = np.divide(1.0, wanted, out=np.zeros_like(wanted), where=wanted > 0)

    def start() -> None:
        given = devices.upload(np.moveaxis(factor, 0, 1).astype(np.float32), kernels.Lanes, device)
        inputs = [*system.across, system.device_depth, given, least]
        launch(kernels.start_density, blocks * voxels, inputs, [filled, now], _SPLIT_FROM)
        project(now, sum_now)

    start()
    # The product has the right shape but not yet the right sum.
    held = _held(sum_now.numpy(), views).mean(axis=0)
    factor[0] *= np.divide(wanted.mean(axis=0), held, out=np.zeros_like(held), where=held > 0)
    start()
    project(filled, residual)
    lengths = residual.numpy()
    weight = np.where(lengths > 0, 1.0 / np.maximum(lengths, _LEAST_LENGTH), 0.0).astype(np.float32)
    weights = devices.upload(weight, kernels.Lanes, device)
    fill = np.zeros((blocks, kernels.LANES), np.float32)
    age, best = (devices.upload(fill + x, kernels.Lanes, device) for x in (1.0, np.finfo(np.float32).max))
    plain, momentum = (devices.zeros(blocks, kernels.Lanes, device) for _ in range(2))
    exact = system.depth.astype(np.float64) ** 2
    target, most = tolerance**2 * float(exact.sum()), float((weight * exact).sum())
    before = np.inf
    for round_ in range(iterations + 1):
        launch(
            kernels.pace_rows,
            blocks,
            [system.device_depth, weights, sum_now, sum_last if round_ else sum_now],
            [age, best, plain, momentum, residual],
            2,
        )
        if round_ == iterations:
            break
        if round_ % _LOOK == 0:
            fits = float(plain.numpy().sum(dtype=np.float64)) <= target
            left = float(np.sqrt(best.numpy().sum(dtype=np.float64) / max(most, 1e-30)))
            if fits or before - left <= _STALL * tolerance:
                break
            before = left
        if round_ == 0:
            last = wp.clone(now)
        inputs = [*system.across, views, residual, momentum, filled, now]
        launch(kernels.step_density, blocks * voxels, inputs, [last], _SPLIT_FROM)
        now, last = last, now
        sum_now, sum_last = sum_last, sum_now
        project(now, sum_now)
    worse = momentum.numpy() < 0
    density: _Floats = now.numpy()
    if worse.any():
        density = np.where(worse[:, None], last.numpy(), density)
    return density


class _System(NamedTuple):
    along: list[Any]  # start, voxel, share of each ray's entries, on the device
    across: list[Any]  # start, ray, share of each voxel's entries, view by view, on the device
    depth: _Floats  # (blocks, rays, lanes)
    device_depth: Any
    blocks: int
    rays: int
    voxels: int


def _upload(
    shares: Sequence[sparse.csr_array], depths: Sequence[NDArray[np.floating[Any]]], device: str
) -> _System:
    stacked = sparse.vstack(shares).tocsr()
    rays, voxels = stacked.shape
    views = len(shares)
    along = [stacked.indptr, stacked.indices, stacked.data]
    ray = np.repeat(np.arange(rays), np.diff(stacked.indptr))
    # Rays count on from view to view, so a voxel's entries, sorted by their rays, are sorted by views.
    turned = sparse.csr_array(
        (stacked.data, (stacked.indices * views + ray // (rays // views), ray)), shape=(voxels * views, rays)
    )
    across = [turned.indptr, turned.indices, turned.data]
    kinds = ((np.int32, wp.int32), (np.int32, wp.int32), (np.float32, wp.float32))
    along, across = (
        [devices.upload(a.astype(of), to, device) for a, (of, to) in zip(part, kinds, strict=True)]
        for part in (along, across)
    )
    rows = depths[0].shape[1]
    blocks = -(-rows // kernels.LANES)
    depth = np.zeros((rays, blocks * kernels.LANES), np.float32)
    depth[:, :rows] = np.concatenate(depths)
    depth = np.ascontiguousarray(depth.reshape(rays, blocks, kernels.LANES).swapaxes(0, 1))
    device_depth = devices.upload(depth, kernels.Lanes, device)
    return _System(along, across, depth, device_depth, blocks, rays, voxels)


def _held(depth: _Floats, views: int) -> NDArray[np.float64]:
    """Total depth (views, blocks, lanes) that each view shows of each height."""
    blocks, rays, lanes = depth.shape
    total: NDArray[np.float64] = depth.reshape(blocks, views, rays // views, lanes).sum(
        axis=2, dtype=np.float64
    )
    return np.moveaxis(total, 1, 0).copy()
