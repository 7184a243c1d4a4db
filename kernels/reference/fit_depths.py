"""The float64 twin of `flowtree.kernels.fit_depths`; arrays have the lanes as their last axis."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

_Array = NDArray[Any]

FARTHEST = 20.0


def sum_shares(
    low: int, high: int, column: _Array, share: _Array, block: int, values: _Array
) -> NDArray[np.float64]:
    """A row of a sparse matrix, its entries from ``low`` on and before ``high``, times the block's values."""
    total = np.zeros(values.shape[2])
    for entry in range(low, high):
        total += np.float64(share[entry]) * values[block, column[entry]]
    return total


def sum_depths(
    first: int, ray_start: _Array, ray_voxel: _Array, ray_share: _Array, density: _Array, depth_out: _Array
) -> None:
    """Sums the densities along the rays; an index for each ray of each block of heights."""
    blocks, rays = depth_out.shape[:2]
    for i in range(first, blocks * rays):
        block, ray = divmod(i, rays)
        depth_out[block, ray] = sum_shares(
            ray_start[ray], ray_start[ray + 1], ray_voxel, ray_share, block, density
        )


def start_density(
    first: int,
    voxel_start: _Array,
    voxel_ray: _Array,
    voxel_share: _Array,
    depth: _Array,
    factor: _Array,
    least: float,
    filled_out: _Array,
    density_out: _Array,
) -> None:
    """The product of the depths that the views show of each voxel, 0 where one of them shows too little."""
    blocks, voxels = density_out.shape[:2]
    views = factor.shape[1]
    for i in range(first, blocks * voxels):
        block, voxel = divmod(i, voxels)
        rows = voxel * views + np.arange(views)
        shown = np.array(
            [
                sum_shares(voxel_start[row], voxel_start[row + 1], voxel_ray, voxel_share, block, depth)
                for row in rows
            ]
        )
        filled_out[block, voxel] = shown.min(axis=0) >= least
        density_out[block, voxel] = np.prod(shown * factor[block], axis=0) * filled_out[block, voxel]


def shape_density(
    first: int,
    place: _Array,
    axis_x: _Array,
    axis_z: _Array,
    profile: _Array,
    filled: _Array,
    density_out: _Array,
) -> None:
    """Round slices: what the profile says of each voxel's distance from the axis, linear in between."""
    blocks, voxels = density_out.shape[:2]
    last = profile.shape[1] - 2
    for i in range(first, blocks * voxels):
        block, voxel = divmod(i, voxels)
        x = np.float64(place[voxel, 0]) - axis_x[block]
        z = np.float64(place[voxel, 1]) - axis_z[block]
        radius = np.clip(np.hypot(x, z) - 0.5, 0.0, last + 1)
        ring = np.minimum(radius.astype(int), last)
        share = radius - ring
        lane = np.arange(len(ring))
        density = (1.0 - share) * profile[block, ring, lane] + share * profile[block, ring + 1, lane]
        density_out[block, voxel] = density * filled[block, voxel]


def compare_depths(first: int, depth: _Array, known: _Array, sum_now: _Array, log_ratio_out: _Array) -> None:
    """How many times too little the sums along the rays are, as a logarithm of at most `FARTHEST`."""
    blocks, rays = depth.shape[:2]
    for i in range(first, blocks * rays):
        block, ray = divmod(i, rays)
        says = (known[block, ray] > 0.0) & (sum_now[block, ray] > 0.0)
        wanted = np.maximum(np.asarray(depth[block, ray], np.float64), 1e-30)
        ratio = np.log(wanted) - np.log(np.where(says, np.asarray(sum_now[block, ray], np.float64), 1.0))
        log_ratio_out[block, ray] = np.where(says, np.clip(ratio, -FARTHEST, FARTHEST), 0.0)


def scale_density(
    first: int,
    voxel_start: _Array,
    voxel_ray: _Array,
    voxel_share: _Array,
    views: int,
    log_ratio: _Array,
    power: float,
    density_out: _Array,
) -> None:
    """Multiplies the densities with a power of the product of the ratios that the views want."""
    blocks, voxels = density_out.shape[:2]
    for i in range(first, blocks * voxels):
        block, voxel = divmod(i, voxels)
        low, high = voxel_start[voxel * views], voxel_start[(voxel + 1) * views]
        more = sum_shares(low, high, voxel_ray, voxel_share, block, log_ratio)
        density_out[block, voxel] *= np.exp(np.clip(power * more, -FARTHEST, FARTHEST))


def pace_rows(
    first: int,
    depth: _Array,
    known: _Array,
    weight: _Array,
    sum_now: _Array,
    sum_before: _Array,
    age_out: _Array,
    best_out: _Array,
    plain_out: _Array,
    momentum_out: _Array,
    residual_out: _Array,
) -> None:
    """Nesterov's momentum for every height, begun anew where a step made the residual larger."""
    for block in range(first, len(depth)):
        rest = known[block] * (np.asarray(depth[block], np.float64) - sum_now[block])
        plain_out[block] = (rest**2).sum(axis=0)
        square = (rest**2 * weight[block]).sum(axis=0)
        for lane in range(depth.shape[2]):
            age = np.float64(age_out[block, lane])
            if age == 0.0:  # the step after the one taken back has no momentum and is always right
                momentum_out[block, lane] = 0.0
                age_out[block, lane] = 1.0
                best_out[block, lane] = min(best_out[block, lane], square[lane])
            elif square[lane] > best_out[block, lane]:
                momentum_out[block, lane] = -1.0
                age_out[block, lane] = 0.0
            else:
                older = (1.0 + np.sqrt(1.0 + 4.0 * age**2)) / 2.0
                momentum_out[block, lane] = (age - 1.0) / older
                age_out[block, lane] = older
                best_out[block, lane] = square[lane]
        change = np.asarray(sum_now[block], np.float64) - sum_before[block]
        ahead = rest - known[block] * momentum_out[block] * change
        residual_out[block] = ahead * weight[block]


def step_density(
    first: int,
    voxel_start: _Array,
    voxel_ray: _Array,
    voxel_share: _Array,
    views: int,
    residual: _Array,
    momentum: _Array,
    filled: _Array,
    density: _Array,
    density_out: _Array,
) -> None:
    """Goes on as the last step did and spreads the rays' residuals; what is negative becomes 0."""
    blocks, voxels = density.shape[:2]
    for i in range(first, blocks * voxels):
        block, voxel = divmod(i, voxels)
        low, high = voxel_start[voxel * views], voxel_start[(voxel + 1) * views]
        more = sum_shares(low, high, voxel_ray, voxel_share, block, residual) / views
        now = np.asarray(density[block, voxel], np.float64)
        ahead = now + momentum[block] * (now - density_out[block, voxel]) + more
        density_out[block, voxel] = np.maximum(ahead, 0.0) * filled[block, voxel]
