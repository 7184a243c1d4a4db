"""What eyes near the tree see of a box of densities (Particle Flows, equation 1)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import warp as wp
from numpy.typing import NDArray

from flowtree import device as devices
from flowtree.density.upload_sights import upload_sights
from flowtree.geometry.projection import Sight
from flowtree.kernels.fit_sights import sum_sights

_SPLIT_FROM = 64  # an index is a line of sight


def project_sights(
    density: NDArray[np.float32],
    sights: Sequence[Sight],
    *,
    left: float,
    cell: float,
    columns: int,
    rows: int,
    device: str,
    looked_at: NDArray[np.bool_] | None = None,
) -> NDArray[np.float32]:
    """Sums densities along the lines of sight through the cells of pictures of the planes through the axis.

    Args:
        density: (nx, ny, nz) depth of each voxel of a box that stands on the ground, its axis in the middle.
        sights: of the views.
        left: image-right coordinate of the pictures' first line [m].
        cell: edge of a voxel and of a picture's cell [m].
        columns: of each picture.
        rows: of each picture, up from the ground.
        device: to run on.
        looked_at: (views, columns, rows) cells that are wanted; None for all.

    Returns: (views, columns, rows) optical depth; 0 in cells that are not wanted.
    """
    side = density.shape[0]
    shape = (len(sights), columns, rows)
    wanted = np.ones(shape, np.float32) if looked_at is None else looked_at.astype(np.float32)
    inputs = [
        upload_sights(sights, left=left, cell=cell, corner=-side / 2 * cell, device=device),
        devices.upload(wanted, wp.float32, device),
        devices.upload(density.astype(np.float32), wp.float32, device),
        int(np.ceil(side / np.sqrt(2.0))),  # to the box's corners
    ]
    depth = devices.zeros(shape, wp.float32, device)
    devices.launch(sum_sights, wanted.size, inputs, [depth], device=device, split_from=_SPLIT_FROM)
    seen: NDArray[np.float32] = depth.numpy()
    return seen
