"""The volume seen again from a view (Particle Flows, figure 3d)."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from flowtree import device as devices
from flowtree.density.footprint_matrix import footprint_matrix
from flowtree.density.project_sights import project_sights
from flowtree.model.camera import Camera
from flowtree.model.volume import DensityVolume


def project_density(volume: DensityVolume, camera: Camera) -> NDArray[np.float32]:
    """Alpha of the volume in a camera's picture, by the emission-absorption model without scattering.

    Args:
        volume: the densities.
        camera: any view; the picture has its size.

    Returns: (camera.height, camera.width) float32 in 0..1. Between the centres of voxels it is interpolated.
    """
    nx, ny, nz = volume.density.shape
    cell = float(volume.voxel)
    scale = camera.metres_per_pixel
    x = np.asarray(float(volume.origin[0]) + (np.arange(nx) + 0.5) * cell, np.float64)
    z = np.asarray(float(volume.origin[2]) + (np.arange(nz) + 0.5) * cell, np.float64)
    reach = float(np.hypot(np.abs(x).max() + cell, np.abs(z).max() + cell))
    columns = 2 * int(np.ceil(reach / cell))
    left = -columns / 2 * cell
    if math.isfinite(camera.distance):
        rows = math.ceil(max(camera.foot[1] * scale, 0.0) / cell) + 1
        seen = project_sights(
            volume.density * np.float32(cell),
            [camera],
            left=left,
            cell=cell,
            columns=columns,
            rows=rows,
            device=devices.pick_device(None),
        )
        depth = seen[0].astype(np.float64)
    else:
        matrix = footprint_matrix(x, z, camera.yaw, left=left, cell=cell, columns=columns)
        depth = np.asarray(matrix @ volume.density.transpose(0, 2, 1).reshape(nx * nz, ny).astype(np.float64))
    alpha = -np.expm1(-depth)
    u = ((np.arange(camera.width) + 0.5 - camera.foot[0]) * scale - left) / cell - 0.5
    v = ((camera.foot[1] - np.arange(camera.height) - 0.5) * scale - volume.origin[1]) / cell - 0.5
    return _sample(alpha, np.asarray(u, np.float64), np.asarray(v, np.float64)).T.astype(np.float32)


def _sample(grid: NDArray[np.float64], u: NDArray[np.float64], v: NDArray[np.float64]) -> NDArray[np.float64]:
    """Bilinear values at every (u, v), 0 outside the grid: (len(u), len(v))."""
    padded = np.pad(grid, 1)

    def split(t: NDArray[np.float64], n: int) -> tuple[NDArray[np.int_], NDArray[np.float64]]:
        place = np.clip(t + 1, 0, n + 1)
        low = np.minimum(place.astype(int), n)
        return low, place - low

    i, a = split(u, grid.shape[0])
    j, b = split(v, grid.shape[1])
    along = padded[i] * (1 - a)[:, None] + padded[i + 1] * a[:, None]
    return np.asarray(along[:, j] * (1 - b) + along[:, j + 1] * b)
