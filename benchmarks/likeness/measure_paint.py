"""Whether what is painted into one view changes the tree there, and nowhere else."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from benchmarks.likeness.bench import Bench, Row, mean
from benchmarks.likeness.make_known import make_known, see_alpha
from benchmarks.likeness.measure_holes import place_hole
from benchmarks.likeness.show_sheet import show_sheet
from benchmarks.measure_truth import INPUTS, Truth, load_truth
from flowtree.geometry.footprint_means import footprint_means
from flowtree.geometry.projection import project
from flowtree.geometry.stroke_share import stroke_share
from flowtree.model.camera import Camera
from flowtree.model.edit import PaintedEdit
from flowtree.model.skeleton import Skeleton

_ERASED, _ADDED, _OUTSIDE = 0.15, 0.5, 0.03
_LED = 0.5  # weight of a direction where branches are asked whether they follow it
_TURNED = 0.6  # cosine with the direction drawn
_CELLS = 64  # along the height, as in soft IoU
_THERE = 0.02  # alpha from which on a cell holds something


def measure_paint(bench: Bench, names: Sequence[str]) -> list[Row]:
    """A disc of a tenth of the crown erased, one added beside the crown, and one where branches shall hang.

    All in the first view. Alpha is that of the finished tree from there. Away from the paint its mean change
    counts, over the cells of soft IoU (a leaf may move by its own width) that hold something before or after.
    Where a direction is drawn the branches' cosine with it counts, every one by its length.
    """
    erased, added, turned, before_turn, outside = {}, {}, {}, {}, {}
    yaw = INPUTS[0]
    for name in names:
        truth = load_truth(bench.data / "truth" / name)
        plain = make_known(bench, truth)
        before = see_alpha(plain, truth, yaw)
        hole = place_hole(truth, yaw)
        more = place_addition(truth, yaw, hole)
        edits = {
            "erased": (hole, PaintedEdit(erase=hole.astype(np.float32))),
            "added": (more, PaintedEdit(add=more.astype(np.float32))),
            "turned": (hole, _droop(hole, truth.cameras[yaw].foot[0])),
        }
        for item, (place, edit) in edits.items():
            made = make_known(bench, truth, paint={0: edit})
            show_sheet(bench, f"{item}_{name}", made)
            after = see_alpha(made, truth, yaw)
            outside[f"{name} {item}"] = _change_beside(before, after, place.astype(np.float32), truth, yaw)
            if item == "turned":
                turned[name] = _along(made.skeleton, edit, place, truth.cameras[yaw])
                before_turn[name] = _along(plain.skeleton, edit, place, truth.cameras[yaw])
            else:
                (erased if item == "erased" else added)[name] = float(after[place].mean())
    return [
        Row("alpha where the crown was erased, worst", _ERASED, max(erased.values()), erased, at_most=True),
        Row("alpha where crown was added, worst", _ADDED, min(added.values()), added),
        Row("cosine of branches with a drawn direction, mean", _TURNED, mean(turned), turned),
        Row("the same without it, mean", None, mean(before_turn), before_turn),
        Row("change of alpha away from that, worst", _OUTSIDE, max(outside.values()), outside, at_most=True),
    ]


def _droop(place: NDArray[np.bool_], foot: float) -> PaintedEdit:
    """Branches in a disc (h, w) hang: the flow climbs from its lower rim toward the column of the foot."""
    rows, columns = np.nonzero(place)
    middle = np.array([columns.mean(), rows.mean()]) + 0.5
    reach = float(np.sqrt(len(rows) / np.pi))
    half = 0.6 * reach * np.array([1.0 if middle[0] > foot else -1.0, 1.0])
    return PaintedEdit(
        directions=(np.stack([middle + half, middle - half]).astype(np.float32),), reach=(reach,)
    )


def _along(skeleton: Skeleton, edit: PaintedEdit, place: NDArray[np.bool_], camera: Camera) -> float:
    """Mean cosine, in the view, between the branches' ways to the foot and the direction drawn there."""
    line, reach = edit.directions[0], edit.reach[0]
    pixels = project(skeleton.points, camera)
    way = (pixels[np.maximum(skeleton.parent, 0)] - pixels)[1:]
    middle = pixels[1:] + 0.5 * way
    column, row = np.clip(middle.astype(int).T, 0, np.array(place.shape[::-1])[:, None] - 1)
    length = np.linalg.norm(way, axis=1)
    on_line = stroke_share(middle, [line.astype(np.float64)], [reach])[0] > _LED
    counts = place[row, column] & on_line & ~skeleton.twig[1:] & (length > 0.0)
    wanted = (line[1] - line[0]) / np.linalg.norm(line[1] - line[0])
    total = float(length[counts].sum())
    return float((way[counts] @ wanted).sum()) / total if total > 0.0 else 0.0


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
