"""Whether drawn branches become branches."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from benchmarks.likeness.bench import Bench, Row, mean
from benchmarks.likeness.load_stems import load_stems
from benchmarks.likeness.make_known import make_known
from benchmarks.likeness.show_sheet import show_sheet
from benchmarks.likeness.wood_nearby import sample_lines, sample_wood, share_near
from benchmarks.measure_truth import INPUTS, Truth, load_truth
from flowtree.geometry.projection import pixels_to_plane, project

_ASKED = 0.95
_NEAR = 0.015  # [tree heights]
_COUNT = 3
# How far branches worth drawing reach to the side, and how far the middles of two are apart [tree heights].
_REACH, _APART = 0.12, 0.1
_HAND = 0.04  # between two points of a stroke [tree heights]: a hand draws no finer


def measure_strokes(bench: Bench, names: Sequence[str]) -> list[Row]:
    """Three branches of each tree drawn over in its first view: the share of them with wood nearby there."""
    whole, limbs = {}, {}
    for name in names:
        truth = load_truth(bench.data / "truth" / name)
        stems, _ = load_stems(bench.data / "truth" / name)
        strokes = draw_strokes(truth, stems, INPUTS[0])
        made = make_known(bench, truth, strokes={0: strokes})
        show_sheet(bench, f"strokes_{name}", made)
        lines = [pixels_to_plane(stroke, truth.cameras[INPUTS[0]]) for stroke in strokes]
        start, end = (np.concatenate([line[part] for line in lines]) for part in (slice(-1), slice(1, None)))
        drawn = sample_lines(start, end, np.zeros((len(start), 2)), truth.height)
        for items, twigs in ((whole, True), (limbs, False)):
            wood = sample_wood(made.skeleton, truth.height, twigs=twigs).seen_from(INPUTS[0])
            items[name] = share_near(drawn, wood, _NEAR * truth.height)
    return [
        Row("drawn strokes with wood along them", _ASKED, mean(whole), whole),
        Row("the same, without small twigs", None, mean(limbs), limbs),
    ]


def draw_strokes(truth: Truth, stems: Sequence[NDArray[np.float64]], yaw: int) -> list[NDArray[np.float32]]:
    """The thickest branches as a hand would follow them: lines (n, 2) [pixels], from the trunk outwards.

    Branches that do not reach out to a side, or lie beside one already drawn, are passed over.
    """
    strokes: list[NDArray[np.float32]] = []
    middles: list[NDArray[np.float64]] = []
    for stem in sorted(stems[1:], key=lambda line: -float(line[0, 3])):
        line = project(stem[:, :3], truth.cameras[yaw])
        unit = truth.height / truth.cameras[yaw].metres_per_pixel
        away = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
        count = round(float(away[-1]) / (_HAND * unit))
        middle = line[len(line) // 2]
        beside = any(np.linalg.norm(middle - other) < _APART * unit for other in middles)
        if abs(line[-1, 0] - line[0, 0]) < _REACH * unit or beside:
            continue
        at = np.linspace(0.0, away[-1], count + 1)
        strokes.append(np.stack([np.interp(at, away, axis) for axis in line.T], axis=1).astype(np.float32))
        middles.append(middle)
        if len(strokes) == _COUNT:
            break
    return strokes
