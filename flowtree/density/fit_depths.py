"""The least-squares densities of a stack of height slices (Particle Flows, section 5)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sparse
import warp as wp
from numpy.typing import NDArray

from flowtree import device as devices
from flowtree.density.round_slices import RoundSlices
from flowtree.kernels import fit_depths as kernels

_SPLIT_FROM = 128  # an index is hundreds of products
_LOOK = 5  # rounds in which the residual must fall, for momentum comes and goes
_STALL = 0.03  # of the tolerance: a residual that falls by less in those rounds is near its least
_LEAST_LENGTH = 0.1  # voxels; a ray that grazes less weighs no more

_LARGEST = 1e30
_ROUNDINGS = 5  # rounds in which round slices are scaled to what the views show: more change nothing
_SHOWN = 1e3  # the depth of a ray that is not known, where a voxel is to be carved or not

_Floats = NDArray[np.float32]
_Doubles = NDArray[np.float64]


def fit_depths(
    shares: Sequence[sparse.csr_array],
    depths: Sequence[NDArray[np.floating[Any]]],
    *,
    least: float,
    iterations: int,
    tolerance: float,
    device: str,
    known: Sequence[NDArray[np.bool_]] | None = None,
    prior: RoundSlices | None = None,
) -> _Floats:
    """Finds densities >= 0 that add up to the views' depths, height by height.

    The start is the product of the views' depths at each voxel, scaled to the depth that the height holds.
    Where there is a prior it is the prior instead, scaled along all rays of all views at once, again and
    again (the simultaneous multiplicative algebraic reconstruction technique): that tends to what satisfies
    the views and is, in relative entropy, nearest to the prior. From there projected gradient steps
    (simultaneous iterative reconstruction: residuals over path lengths go back along their rays) with
    Nesterov's momentum (Beck and Teboulle 2009) lower the sum of the rays' squared residuals, each over the
    ray's length through voxels that may be filled. Whenever momentum made that sum larger for a height, it
    begins anew there (O'Donoghue and Candès 2015) and the step is taken back: no further round makes a result
    worse.

    The relative residual is ``|A x - d| / |d|`` over all rays, x the densities and d the depths. The rounds
    end when it is at most ``tolerance``. Views that contradict each other leave some of it in any case: then
    they end when five rounds lower it, the rays weighted as above, by less than 3 % of ``tolerance``. For a
    tolerance of 0.001 it is then less than that above the least in photographs of trees. Or they end after
    ``iterations``.

    Args:
        shares: one a view, (columns, voxels): the share of a voxel's matter that each ray meets; a voxel's
            shares sum to 1.
        depths: one a view, (columns, rows), optical depth along each ray of each height.
        least: depth that every view must show of a voxel that may be filled.
        iterations: rounds at most.
        tolerance: relative residual at which the rounds end.
        device: to run on.
        known: one a view, (columns, rows), rays whose depth counts; all where left out. The others carve
            nothing.
        prior: what the densities are like where the views say nothing.

    Returns: (blocks, voxels, lanes) float32, heights in runs of `kernels.LANES`: the depth of each voxel,
        that is its density times its edge; zeros above the last row.
    """
    rays = _upload_rays(shares, depths, known, device)
    now, filled = _start(rays, least)
    if prior is not None:
        now = _round(rays, prior, filled)
    weight = _weights(rays.project(filled, rays.new(rays.rays)).numpy())
    weights = devices.upload(weight, kernels.Lanes, device)
    last, sum_last, residual = rays.new(rays.voxels), rays.new(rays.rays), rays.new(rays.rays)
    sum_now = rays.project(now, rays.new(rays.rays))
    fill = np.zeros((rays.blocks, kernels.LANES), np.float32)
    age, best = (devices.upload(fill + x, kernels.Lanes, device) for x in (1.0, np.finfo(np.float32).max))
    plain, momentum = (devices.zeros(rays.blocks, kernels.Lanes, device) for _ in range(2))
    square = rays.depth.numpy().astype(np.float64) ** 2
    all_plain, all_weighted = float(square.sum()), float((weight * square).sum())
    before = np.inf
    for done in range(iterations + 1):
        inputs = [rays.depth, rays.known, weights, sum_now, sum_last]
        outputs = [age, best, plain, momentum, residual]
        devices.launch(kernels.pace_rows, rays.blocks, inputs, outputs, device=device, split_from=2)
        if done == iterations or _relative(plain, all_plain) <= tolerance:
            break
        if done % _LOOK == 0:
            left = _relative(best, all_weighted)
            if before - left <= _STALL * tolerance:
                break
            before = left
        inputs = [*rays.across, rays.views, residual, momentum, filled, now]
        rays.launch(kernels.step_density, rays.voxels, inputs, [last])
        now, last, sum_now, sum_last = last, now, sum_last, sum_now
        rays.project(now, sum_now)
    density: _Floats = now.numpy()
    worse = momentum.numpy() < 0.0  # where the last step is taken back
    return np.where(worse[:, None], last.numpy(), density) if worse.any() else density


@dataclass(frozen=True)
class _Rays:
    """All views' rays through the slices, on the device.

    Attributes:
        along: start, voxel and share of each ray's entries.
        across: start, ray and share of each voxel's entries, view by view.
        depth: (blocks, rays) lanes; 0 where not known.
        known: (blocks, rays) lanes, 1 or 0.
        blocks: runs of `kernels.LANES` heights.
        rays: of all views, in a slice.
        voxels: in a slice.
        views: how many.
        device: all of this lies on.
    """

    along: list[Any]
    across: list[Any]
    depth: Any
    known: Any
    blocks: int
    rays: int
    voxels: int
    views: int
    device: str

    def new(self, columns: int) -> Any:
        """(blocks, columns) lanes of zeros."""
        return devices.zeros((self.blocks, columns), kernels.Lanes, self.device)

    def launch(self, kernel: Any, columns: int, inputs: list[Any], outputs: list[Any]) -> None:
        """Runs a kernel over the columns of all blocks."""
        count = self.blocks * columns
        devices.launch(kernel, count, inputs, outputs, device=self.device, split_from=_SPLIT_FROM)

    def project(self, density: Any, out: Any) -> Any:
        """Sums (blocks, voxels) along the rays into ``out`` (blocks, rays)."""
        self.launch(kernels.sum_depths, self.rays, [*self.along, density], [out])
        return out

    def held(self, depth: Any) -> _Doubles:
        """Total depth (blocks, views, lanes) of each height in each view."""
        parts = depth.numpy().reshape(self.blocks, self.views, -1, kernels.LANES)
        return np.asarray(parts.sum(axis=2, dtype=np.float64))


def _upload_rays(
    shares: Sequence[sparse.csr_array],
    depths: Sequence[NDArray[np.floating[Any]]],
    known: Sequence[NDArray[np.bool_]] | None,
    device: str,
) -> _Rays:
    along = sparse.vstack(shares).tocsr()
    rays, voxels = along.shape
    views = len(shares)
    ray = np.repeat(np.arange(rays), np.diff(along.indptr))
    entries = (along.data, (along.indices * views + ray // (rays // views), ray))
    across = sparse.csr_array(entries, shape=(voxels * views, rays))
    sure = np.ones((rays, depths[0].shape[1]), np.bool_) if known is None else np.concatenate(known)
    depth = _in_lanes(np.where(sure, np.concatenate(depths), 0.0))
    return _Rays(
        _upload_matrix(along, device),
        _upload_matrix(across, device),
        devices.upload(depth, kernels.Lanes, device),
        devices.upload(_in_lanes(sure), kernels.Lanes, device),
        len(depth),
        rays,
        voxels,
        views,
        device,
    )


def _in_lanes(values: NDArray[Any]) -> _Floats:
    """(n, rows) as (blocks, n, lanes), zeros above the last row."""
    count, rows = values.shape
    blocks = -(-rows // kernels.LANES)
    lanes = np.zeros((count, blocks * kernels.LANES), np.float32)
    lanes[:, :rows] = values
    return lanes.reshape(count, blocks, kernels.LANES).swapaxes(0, 1)


def _upload_matrix(matrix: sparse.csr_array, device: str) -> list[Any]:
    return [
        devices.upload(matrix.indptr.astype(np.int32), wp.int32, device),
        devices.upload(matrix.indices.astype(np.int32), wp.int32, device),
        devices.upload(matrix.data.astype(np.float32), wp.float32, device),
    ]


def _start(rays: _Rays, least: float) -> tuple[Any, Any]:
    """The product of the views' depths (blocks, voxels), and 1 where a voxel may be filled, else 0."""
    density, filled = rays.new(rays.voxels), rays.new(rays.voxels)
    wanted = rays.held(rays.depth)
    # Over the deepest ray, so that the product of many views does not leave what a float can hold.
    deepest = rays.depth.numpy().reshape(rays.blocks, rays.views, -1, kernels.LANES).max(axis=2)
    factor = np.divide(1.0, deepest, out=np.zeros_like(wanted), where=deepest > 0)
    shown = devices.upload(
        np.where(rays.known.numpy() > 0, rays.depth.numpy(), _SHOWN), kernels.Lanes, rays.device
    )

    def multiply() -> None:
        given = devices.upload(factor.clip(max=_LARGEST).astype(np.float32), kernels.Lanes, rays.device)
        inputs = [*rays.across, shown, given, least]
        rays.launch(kernels.start_density, rays.voxels, inputs, [filled, density])

    multiply()
    # The product has its shape but not yet its sum.
    held = rays.held(rays.project(density, rays.new(rays.rays))).mean(axis=1)
    factor[:, 0] *= np.divide(wanted.mean(axis=1), held, out=np.zeros_like(held), where=held > 0)
    multiply()
    return density, filled


def _round(rays: _Rays, prior: RoundSlices, filled: Any) -> Any:
    """The prior (blocks, voxels) where a voxel may be filled, scaled along the rays to the views' depths."""
    density, log_ratio = rays.new(rays.voxels), rays.new(rays.rays)
    axis = _in_lanes(prior.axis.T)
    inputs = [
        devices.upload(prior.place.astype(np.float32), wp.vec2, rays.device),
        *(devices.upload(axis[:, k], kernels.Lanes, rays.device) for k in range(2)),
        devices.upload(_in_lanes(prior.profile.T), kernels.Lanes, rays.device),
        filled,
    ]
    rays.launch(kernels.shape_density, rays.voxels, inputs, [density])
    sums = rays.new(rays.rays)
    for number in range(_ROUNDINGS):
        rays.project(density, sums)
        rays.launch(kernels.compare_depths, rays.rays, [rays.depth, rays.known, sums], [log_ratio])
        # Two views at a right angle are nearly independent: at first each may be followed all the way.
        power = (1.0 if number else min(2.0, rays.views)) / rays.views
        inputs = [*rays.across, rays.views, log_ratio, power]
        rays.launch(kernels.scale_density, rays.voxels, inputs, [density])
    return density


def _weights(lengths: _Floats) -> _Floats:
    """One over the rays' lengths [voxels] through what may be filled; 0 where there is nothing."""
    return np.where(lengths > 0.0, 1.0 / np.maximum(lengths, _LEAST_LENGTH), 0.0).astype(np.float32)


def _relative(squares: Any, of: float) -> float:
    """Root of the lanes' sum over ``of``."""
    total = float(squares.numpy().sum(dtype=np.float64))
    return float(np.sqrt(total / of)) if of > 0.0 else 0.0
