"""From mattes to the density volume (Particle Flows, section 5)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from flowtree import check
from flowtree.density.footprint_matrix import footprint_matrix
from flowtree.geometry.footprint_means import footprint_means, optical_depth
from flowtree.model.camera import Camera
from flowtree.model.matte import Matte
from flowtree.model.volume import DensityVolume
from flowtree.params import DensityParams


def solve_density(
    mattes: Sequence[Matte], cameras: Sequence[Camera], *, params: DensityParams = DensityParams()
) -> DensityVolume:
    """Estimates the extinction [1/m] in a box of cubic voxels around the tree from two or more views.

    Three steps of section 5: the footprint mean of every view at every voxel, and their minimum, an upper
    limit; carving of the voxels below a threshold; the iterative least-squares solution of the discretised
    emission-absorption equation, in which negative values are empty. In the logarithm of transparency that
    equation (Particle Flows, equation 1) is linear: along a ray the extinctions add up to the optical depth
    ``-ln(1 - alpha)``.

    Deviations: two views leave the system underdetermined, and the iteration keeps whatever its start holds
    in the null space. It therefore starts, not from the minimum, but from the product of the views' optical
    depths over the sum of their row (the choice of maximum entropy: what one view shows is spread over the
    other's profile). Rows of two views that do not hold the same total are first brought to their mean total,
    for a level slice of one tree has only one; ``params.balance`` limits the correction.

    Args:
        mattes: one for each view, at least two.
        cameras: theirs, at two yaws at least that are not opposite.
        params: resolution, carving threshold, iterations.

    Raises:
        InputError: fewer than two views, views that see the tree from the same or the opposite side only,
            a matte that is not finite or holds nothing.
    """
    check.require(
        len(mattes) >= 2, "views", "must be at least two", len(mattes), "add a photo or its mirror image"
    )
    check.require(len(mattes) == len(cameras), "cameras", "must be one a matte", len(cameras), "pass as many")
    sides = {round(camera.yaw % 180.0, 3) for camera in cameras}
    check.require(
        len(sides) > 1, "yaw", "must differ between views", sorted(sides), "give each view its own yaw"
    )
    alphas = [
        check.array(matte.alpha, f"alpha of view {k}", shape=(camera.height, camera.width), low=0.0, high=1.0)
        for k, (matte, camera) in enumerate(zip(mattes, cameras, strict=True))
    ]
    reach, top = _extent(alphas, cameras)
    cell = top / params.resolution
    half = int(np.ceil(reach / cell)) + 1
    rows = params.resolution + 1
    centres = (np.arange(2 * half) + 0.5 - half) * cell
    columns = 2 * int(np.ceil(half * np.sqrt(2.0))) + 2  # the box's diagonal
    left = -columns / 2 * cell
    depths = [
        optical_depth(
            footprint_means(alpha, camera, left=left, bottom=0.0, cell=cell, columns=columns, rows=rows)
        )
        for alpha, camera in zip(alphas, cameras, strict=True)
    ]
    matrices = [
        footprint_matrix(centres, centres, camera.yaw, left=left, cell=cell, columns=columns)
        for camera in cameras
    ]
    depths = _balance_rows(depths, params.balance)
    back = [np.asarray(m.T @ d) / cell for m, d in zip(matrices, depths, strict=True)]
    lowest = np.minimum.reduce(back)
    empty = -np.expm1(-lowest) < params.carve
    start = np.where(empty, 0.0, _maximum_entropy(back, depths, cell))
    density = _least_squares(matrices, depths, start, empty, params.iterations)
    shape = (len(centres), len(centres), rows)
    volume = np.ascontiguousarray(density.reshape(shape).transpose(0, 2, 1), dtype=np.float32)
    check.require(
        bool(volume.any()), "mattes", "must show one tree", "views that share nothing", "check yaw and foot"
    )
    origin = np.array([-half * cell, 0.0, -half * cell], np.float32)
    return DensityVolume(density=volume, origin=origin, voxel=float(cell))


def _extent(alphas: list[NDArray[np.float32]], cameras: Sequence[Camera]) -> tuple[float, float]:
    """Largest distance from the axis and largest height that any view shows [m]."""
    reach = top = 0.0
    for k, (alpha, camera) in enumerate(zip(alphas, cameras, strict=True)):
        seen = alpha > 0.02
        check.require(
            bool(seen.any()), f"matte of view {k}", "must hold a tree", "an empty alpha", "scribble the tree"
        )
        x = np.flatnonzero(seen.any(axis=0))
        y = np.flatnonzero(seen.any(axis=1))
        scale = camera.metres_per_pixel
        reach = max(reach, abs(x[0] - camera.foot[0]) * scale, abs(x[-1] + 1 - camera.foot[0]) * scale)
        top = max(top, (camera.foot[1] - y[0]) * scale)
    check.require(
        top > 0, "foot", "must lie below the tree", "a matte wholly below it", "give the foot's pixel"
    )
    return float(reach), float(top)


def _balance_rows(depths: list[NDArray[np.float64]], limit: float) -> list[NDArray[np.float64]]:
    """Brings each height's total depth to the views' mean, by at most a factor of ``1 + limit``."""
    totals = [d.sum(axis=0) for d in depths]
    mean = np.mean(totals, axis=0)
    balanced = []
    for depth, total in zip(depths, totals, strict=True):
        factor = np.divide(mean, total, out=np.ones_like(mean), where=total > 1e-9)
        balanced.append(depth * np.clip(factor, 1 / (1 + limit), 1 + limit))
    return balanced


def _maximum_entropy(
    back: list[NDArray[np.float64]], depths: list[NDArray[np.float64]], cell: float
) -> NDArray[np.float64]:
    """Product of the back-projected depths over powers of their row sums: (voxels, rows), [1/m].

    For two views at a right angle it satisfies both exactly.
    """
    total = np.mean([d.sum(axis=0) for d in depths], axis=0)
    product = np.multiply.reduce([b.clip(min=0.0) for b in back])
    power = len(back) - 1
    return np.divide(product, total**power * cell, out=np.zeros_like(product), where=total > 1e-9)


def _least_squares(
    matrices: list[NDArray[np.float64]],
    depths: list[NDArray[np.float64]],
    density: NDArray[np.float64],
    empty: NDArray[np.bool_],
    iterations: int,
) -> NDArray[np.float64]:
    """Simultaneous iterative reconstruction: residuals over path lengths go back, negative becomes 0."""
    lengths = [np.maximum(np.asarray(m.sum(axis=1)), 1e-9)[:, None] for m in matrices]
    spread = np.sum([np.asarray(m.sum(axis=0)) for m in matrices], axis=0)[:, None]
    filled = ~empty
    for _ in range(iterations):
        step = np.zeros_like(density)
        for matrix, depth, length in zip(matrices, depths, lengths, strict=True):
            step += matrix.T @ ((depth - matrix @ density) / length)
        density = np.where(filled, np.maximum(density + step / spread, 0.0), 0.0)
    return density
