"""Measures the trunk's thickness in a matte."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flowtree.model.camera import Camera
from flowtree.model.matte import Matte

_FIRST, _LAST = 0.03, 0.15  # of the tree's height: above the flare of the roots, below most first forks
_OPAQUE = 0.5
_THINNEST, _WIDEST = 0.006, 0.16  # of the tree's height: beyond, a run is a blade of grass or a crown
_LEAST_SHARE = 0.4  # of the rows must show a stem
_STEADY = 1.35  # how much wider the upper rows may be than the lower ones before a fork or crown is meant


def measure_trunk(matte: Matte, camera: Camera) -> float | None:
    """Radius [m] of the trunk above its foot.

    In each row between 3 and 15 % of the tree's height the run of opaque pixels that continues the row below
    is measured, and its alpha summed over the run and its soft edges, so that the width is finer than a
    pixel. Where the run becomes much wider than it was below, a fork or the crown has begun. The median
    counts.

    Args:
        matte: of the view.
        camera: as `frame_view` gives it for the matte.

    Returns: half the median width; None where no stem is to be seen, as with a crown down to the ground.
    """
    alpha = matte.alpha
    rows = alpha.shape[0]
    tall = _tree_pixels(alpha, camera)
    if tall < 16.0:
        return None
    low = min(round(camera.foot[1] - 1.0), rows - 1)
    high = max(0, round(camera.foot[1] - _LAST * tall))
    first = camera.foot[1] - _FIRST * tall
    centre = camera.foot[0] - 0.5
    widths: list[float] = []
    seen = 0
    for row in range(low, high - 1, -1):
        seen += row <= first
        run = _run_at(alpha[row], centre, reach=0.04 * tall)
        if run is None:
            continue
        begin, end = run
        width = float(alpha[row, begin:end].sum())
        if not _THINNEST * tall <= width <= _WIDEST * tall:
            continue
        if row <= first:
            if len(widths) >= 4 and width > _STEADY * float(np.median(widths)):
                continue
            widths.append(width)
        # The stem may lean: the next row is looked at where this one stands.
        centre += 0.5 * (0.5 * (begin + end - 1) - centre)
    if len(widths) < max(2.0, _LEAST_SHARE * seen):
        return None
    return 0.5 * float(np.median(widths)) * camera.metres_per_pixel


def _tree_pixels(alpha: NDArray[np.float32], camera: Camera) -> float:
    """Height of what the matte shows above the foot [pixels]."""
    shown = np.flatnonzero((alpha > _OPAQUE).any(axis=1))
    return float(camera.foot[1] - shown[0]) if len(shown) else 0.0


def _run_at(line: NDArray[np.float32], centre: float, *, reach: float) -> tuple[int, int] | None:
    """The run of opaque pixels nearest to a column, with its soft edges: first and one past the last."""
    opaque = line > _OPAQUE
    columns = np.flatnonzero(opaque)
    if len(columns) == 0:
        return None
    nearest = int(columns[np.argmin(np.abs(columns - centre))])
    if abs(nearest - centre) > reach:
        return None
    begin, end = nearest, nearest + 1
    while begin > 0 and opaque[begin - 1]:
        begin -= 1
    while end < len(line) and opaque[end]:
        end += 1
    # A soft edge belongs to the run as long as alpha falls, at most two pixels wide.
    for _ in range(2):
        if begin > 0 and line[begin - 1] < line[begin]:
            begin -= 1
        if end < len(line) and line[end] < line[end - 1]:
            end += 1
    return begin, end
