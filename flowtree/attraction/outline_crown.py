"""Where the crown is and where it begins."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from flowtree.attraction.cut_working_grid import WorkingGrid

_SOLID = 0.15  # alpha from which a cell belongs to the shape
_GAP = 0.035  # of the height: gaps between twigs that the shape closes
_SPECK = 0.02  # of the largest part: smaller parts are no part of the tree


@dataclass(frozen=True)
class CrownOutline:
    """The tree's filled shape on the working grid.

    Attributes:
        shape: (h, w) bool, without the gaps between twigs and leaves.
        depth: (h, w) float32, distance to the shape's edge in tree heights, 0 outside.
        foot: the foot's row.
        base: the row at which the stem widens into the crown; the foot's row where no stem shows.
        narrowness: 0 for a crown widest in its upper half or round, up to 1 for a spire widest at its base.
        stem: half the stem's width [cells] below the base.
    """

    shape: NDArray[np.bool_]
    depth: NDArray[np.float32]
    foot: int
    base: int
    narrowness: float
    stem: float


def outline_crown(grid: WorkingGrid, foot_row: int) -> CrownOutline:
    """Closes the matte to one filled shape and finds the row at which its stem becomes a crown."""
    radius = max(1, round(_GAP * grid.tall))
    kernel = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * radius + 1, 2 * radius + 1))
    # A grid that holds nothing but faint alpha still has a shape: its densest cells.
    level = min(_SOLID, 0.5 * float(grid.alpha.max()))
    solid = np.pad((grid.alpha >= level).astype(np.uint8), radius + 1)
    closed = cv2.morphologyEx(solid, cv2.MORPH_CLOSE, kernel)[
        radius + 1 : -radius - 1, radius + 1 : -radius - 1
    ]
    shape = np.asarray(ndimage.binary_fill_holes(closed > 0), np.bool_)
    labels, count = ndimage.label(shape, structure=np.ones((3, 3), np.int8))
    if count > 1:
        sizes = np.bincount(labels.ravel())
        sizes[0] = 0
        shape = np.asarray((sizes >= _SPECK * sizes.max())[labels], np.bool_)
    inner = np.pad(shape, 1)
    depth = ndimage.distance_transform_edt(inner)[1:-1, 1:-1] / grid.tall
    base, stem = _crown_base(shape, foot_row, grid.tall)
    return CrownOutline(shape, depth.astype(np.float32), foot_row, base, _narrowness(shape, base), stem)


def _crown_base(shape: NDArray[np.bool_], foot_row: int, tall: float) -> tuple[int, float]:
    """The first row above the foot, going up, from which the shape stays much wider than the stem."""
    widths = shape.sum(axis=1).astype(np.float64)
    rows = np.arange(foot_row, -1, -1)
    up = widths[np.clip(rows, 0, len(widths) - 1)]
    if len(up) < 4:
        return foot_row, 1.0
    low, high = int(0.02 * tall), max(int(0.02 * tall) + 2, int(0.07 * tall))
    stem = float(np.median(up[low:high]))
    broad = up > max(2.2 * stem, stem + 0.06 * tall)
    need = max(2, round(0.02 * tall))
    run = 0
    for i, wide in enumerate(broad):
        run = run + 1 if wide else 0
        if run == need:
            return int(rows[i - need + 1]), stem / 2.0
    return foot_row, stem / 2.0


def _narrowness(shape: NDArray[np.bool_], base: int) -> float:
    """How much of a spire the crown is: its upper third against its lower third, and its slenderness."""
    rows = np.flatnonzero(shape[: base + 1].any(axis=1))
    if len(rows) < 6:
        return 0.0
    widths = shape[rows[0] : base + 1].sum(axis=1).astype(np.float64)
    third = max(1, len(widths) // 3)
    taper = 1.0 - widths[:third].mean() / max(1.0, widths[-third:].mean())
    slender = len(widths) / max(1.0, widths.max())
    return float(np.clip((taper - 0.4) / 0.25, 0.0, 1.0) * np.clip(slender, 0.0, 1.0))
