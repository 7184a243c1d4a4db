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
from flowtree.model.edit import PaintedEdit

_ERASED, _ADDED, _OUTSIDE = 0.15, 0.5, 0.03
_AROUND = 0.03  # beside the paint a tree may change, too [tree heights]


def measure_paint(bench: Bench, names: Sequence[str]) -> list[Row]:
    """A disc of a tenth of the crown erased, and one added beside the crown, in the first view.

    Alpha is that of the finished tree from there. Outside: its mean change over what the crown covered, away
    from the paint.
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
            away = _far_from(place, truth, yaw)
            change = np.abs(after - before)[away].sum() / max(float((before[away] > 0).sum()), 1.0)
            outside[f"{name} {item}"] = float(change)
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


def _far_from(place: NDArray[np.bool_], truth: Truth, yaw: int) -> NDArray[np.bool_]:
    rows, columns = np.nonzero(place)
    reach = np.sqrt(len(rows) / np.pi) + _AROUND * truth.height / truth.cameras[yaw].metres_per_pixel
    down, right = np.mgrid[: place.shape[0], : place.shape[1]]
    return (down - rows.mean()) ** 2 + (right - columns.mean()) ** 2 > reach**2
