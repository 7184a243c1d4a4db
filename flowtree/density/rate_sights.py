"""How well views can show one tree."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from flowtree.density.fit_sights import fit_sights
from flowtree.density.project_sights import project_sights
from flowtree.density.round_slices import fill_box, round_slices
from flowtree.geometry.projection import Sight

_LEAST = 0.01  # depth of what may hold a tree
_SMOOTH = 0.75  # cells: what is that near counts as the same place


def rate_sights(
    depths: Sequence[NDArray[np.float64]],
    known: Sequence[NDArray[np.bool_]],
    sights: Sequence[Sight],
    *,
    side: int,
    height: int,
    left: float,
    cell: float,
    device: str,
) -> float:
    """What the density that fits views best (`fit_sights`) leaves of their optical depths, over all of them.

    Args:
        depths: one a view, (columns, rows) of the plane that faces it, row 0 on the ground.
        known: one a view, cells that count.
        sights: of the views.
        side: voxels along x and z of the box.
        height: voxels along y of the box, the tree's height and no more.
        left: image-right coordinate of the first column's left line [m].
        cell: edge of a cell and of a voxel [m].
        device: to run on.

    Returns: 0 where all views show one tree exactly.
    """
    centres = np.arange(side) + 0.5 - side / 2
    prior = round_slices(depths, known, [sight.yaw for sight in sights], np.asarray(centres, np.float64))
    start = fill_box(prior, side)[:, :height]
    fitted = fit_sights(depths, known, sights, start=start, left=left, cell=cell, least=_LEAST, device=device)
    columns, rows = depths[0].shape
    shown = project_sights(
        fitted,
        sights,
        left=left,
        cell=cell,
        columns=columns,
        rows=rows,
        device=device,
        looked_at=np.stack(list(known)),
    )
    rest = total = 0.0
    for depth, sure, other in zip(depths, known, shown, strict=True):
        wanted, made = (
            cv2.GaussianBlur((picture * sure).astype(np.float32), (0, 0), _SMOOTH)
            for picture in (depth, other)
        )
        rest += float(np.abs(wanted - made).sum(dtype=np.float64))
        total += float(wanted.sum(dtype=np.float64))
    return rest / max(total, 1e-9)
