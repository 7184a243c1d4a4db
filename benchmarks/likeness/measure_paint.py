"""Whether what is painted into one view changes the tree there, and nowhere else."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from benchmarks.likeness.bench import Bench, Row
from benchmarks.likeness.make_known import make_known, see_alpha
from benchmarks.likeness.measure_holes import place_hole
from benchmarks.likeness.show_sheet import show_sheet
from benchmarks.measure_truth import INPUTS, Truth, load_truth
from flowtree.geometry.footprint_means import footprint_means
from flowtree.model.edit import PaintedEdit

_ERASED, _ADDED, _OUTSIDE = 0.15, 0.5, 0.03
_CELLS = 64  # along the height, as in soft IoU
_THERE = 0.02  # alpha from which on a cell holds something


def measure_paint(bench: Bench, names: Sequence[str]) -> list[Row]:
    """A disc of a tenth of the crown erased, and one added beside the crown, in the first view.

    Alpha is that of the finished tree from there. Away from the paint its mean change counts, over the cells
    of soft IoU (a leaf may move by its own width) that hold something before or after.
    """
    erased, added, outside = {}, {}, {}
    yaw = INPUTS[0]
    for name in names:
        truth = load_truth(bench.data / "truth" / name)
        before = see_alpha(make_known(bench, truth), truth, yaw)
        hole = place_hole(truth, yaw)
        more = place_addition(truth, yaw, hole)
        for item, place, reached in (("erased", hole, erased), ("added", more, added)):
            paint = place.astype(np.float32)
            edit = PaintedEdit(erase=paint) if item == "erased" else PaintedEdit(add=paint)
            made = make_known(bench, truth, paint={0: edit})
            show_sheet(bench, f"{item}_{name}", made)
            after = see_alpha(made, truth, yaw)
            reached[name] = float(after[place].mean())
            outside[f"{name} {item}"] = _change_beside(before, after, paint, truth, yaw)
    return [
        Row("alpha where the crown was erased, worst", _ERASED, max(erased.values()), erased, at_most=True),
        Row("alpha where crown was added, worst", _ADDED, min(added.values()), added),
        Row("change of alpha away from that, worst", _OUTSIDE, max(outside.values()), outside, at_most=True),
    ]


def place_addition(truth: Truth, yaw: int, hole: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """A disc (h, w) as large as the hole, over the edge of the crown on its other side, mostly outside."""
    rows, columns = np.nonzero(hole)
    radius, row = float(np.sqrt(len(rows) / np.pi)), float(rows.mean())
    foot = truth.cameras[yaw].foot[0]
    side = -1.0 if columns.mean() > foot else 1.0
    band = np.abs(np.arange(len(hole)) - row) < radius
    reached = np.flatnonzero((truth.alphas[yaw][band] > 0.5).any(axis=0))
    edge = float(reached[0] if side < 0 else reached[-1])
    down, right = np.mgrid[: hole.shape[0], : hole.shape[1]]
    middle = edge + side * radius / 3.0
    return (down - row) ** 2 + (right - middle) ** 2 <= radius**2


def _change_beside(
    before: NDArray[np.float32],
    after: NDArray[np.float32],
    paint: NDArray[np.float32],
    truth: Truth,
    yaw: int,
) -> float:
    """Mean absolute change of the cells' alpha where nothing is painted."""
    camera, cell = truth.cameras[yaw], truth.height / _CELLS
    half = int(np.ceil(camera.width * camera.metres_per_pixel / cell))
    old, new, cover = (
        footprint_means(
            picture, camera, left=-half * cell, bottom=0.0, cell=cell, columns=2 * half, rows=_CELLS + 2
        )
        for picture in (before, after, paint)
    )
    beside = (cover == 0) & (np.maximum(old, new) > _THERE)
    return float(np.abs(new - old)[beside].mean()) if beside.any() else 0.0
