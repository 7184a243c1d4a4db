"""The densities of a box that look as given from eyes near the tree (Particle Flows, section 5)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import warp as wp
from numpy.typing import NDArray

from flowtree import device as devices
from flowtree.density.upload_sights import upload_sights
from flowtree.geometry.projection import Sight
from flowtree.kernels import fit_sights as kernels

_ROUNDS = 4  # more fit what the views contradict each other in: see `fit_sights`
_NOTHING = 1e-4  # depth that counts as none beside another
_SHOWN = 1e3  # the depth of a line of sight that is not known, where a voxel is to be carved or not
_SPLIT_FROM = 64  # an index is a line of sight or a row of voxels


def fit_sights(
    depths: Sequence[NDArray[np.float64]],
    known: Sequence[NDArray[np.bool_]],
    sights: Sequence[Sight],
    *,
    start: NDArray[np.float32],
    left: float,
    cell: float,
    least: float,
    device: str,
) -> NDArray[np.float32]:
    """Scales densities along the views' lines of sight until they add up to the depths that the views show.

    Through an eye near the tree a picture's row crosses many heights, and the slices of `fit_depths` are no
    problems of their own any more. So every voxel is scaled by what all lines of sight through it ask for,
    all at once (the simultaneous multiplicative algebraic reconstruction technique), which keeps to the start
    where views say nothing. Views of photographs contradict each other, by foot, scale and distance that are
    estimated, and many rounds fit the contradictions: soft IoU with four known trees of the volume from their
    loose photographs, true cameras, was 0.641, 0.639, 0.637 and 0.634 after 4, 8, 15 and 30 rounds, and 0.612
    where the same pictures were taken for parallel projections.

    Args:
        depths: one a view, (columns, rows) of a picture of the plane through the axis that faces it, optical
            depth of each cell; row 0 stands on the ground.
        known: one a view, (columns, rows), cells that count. The others carve and scale nothing.
        sights: of the views.
        start: (nx, ny, nz) depth of each voxel of a box that stands on the ground, its axis in the middle;
            what is 0 stays so.
        left: image-right coordinate of the pictures' first line [m].
        cell: edge of a voxel and of a picture's cell [m].
        least: depth that every view must show of a voxel that may be filled.
        device: to run on.

    Returns: (nx, ny, nz) float32, the depth of each voxel, that is its density times its edge.
    """
    side, height, _ = start.shape
    views = upload_sights(sights, left=left, cell=cell, corner=-side / 2 * cell, device=device)
    wanted = np.stack([np.where(sure, depth, 0.0) for depth, sure in zip(depths, known, strict=True)])
    shown = np.where(np.stack(list(known)), wanted, _SHOWN)
    counts = np.stack(list(known)) & (wanted > 0.0)
    density = devices.upload(start.astype(np.float32), wp.float32, device)
    asked = devices.upload(wanted.astype(np.float32), wp.float32, device)
    depth = devices.zeros(wanted.shape, wp.float32, device)

    def change(kernel: Any, *inputs: Any) -> None:
        devices.launch(
            kernel, side * height, [views, *inputs], [density], device=device, split_from=_SPLIT_FROM
        )

    change(kernels.carve_sights, devices.upload(shown.astype(np.float32), wp.float32, device), least)
    steps = int(np.ceil(side / np.sqrt(2.0)))  # to the box's corners
    for number in range(_ROUNDS):
        inputs = [views, asked, density, steps]
        devices.launch(
            kernels.sum_sights, wanted.size, inputs, [depth], device=device, split_from=_SPLIT_FROM
        )
        ratio = (wanted + _NOTHING) / (depth.numpy() + _NOTHING)
        log_ratio = np.where(counts, np.log(ratio), 0.0).astype(np.float32)
        # Two views at a right angle are nearly independent: at first each may be followed all the way.
        power = (1.0 if number else min(2.0, len(sights))) / len(sights)
        change(kernels.scale_sights, devices.upload(log_ratio, wp.float32, device), power)
    fitted: NDArray[np.float32] = density.numpy()
    return fitted
