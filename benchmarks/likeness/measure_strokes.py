"""Whether drawn branches become branches."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from benchmarks.likeness.bench import Bench, Row, mean
from benchmarks.likeness.make_known import make_known
from benchmarks.likeness.show_sheet import show_sheet
from benchmarks.likeness.wood_nearby import sample_lines, sample_wood, share_near
from benchmarks.measure_truth import INPUTS, Truth, load_truth
from flowtree.geometry.projection import pixels_to_plane

_ASKED = 0.95
_NEAR = 0.015  # [tree heights]
# Three branches: where they leave the trunk [tree heights], at which angle from the upright [degrees, to the
# right], and by how much they have turned toward the upright at their ends [degrees].
_BRANCHES = ((0.30, -65.0, 25.0), (0.42, 55.0, 30.0), (0.55, -40.0, 15.0))
_STEP, _LONGEST = 0.01, 0.6  # [tree heights]
_BLUR, _INSIDE = 0.03, 0.15  # a crown's edge: smoothed by [tree heights], to this share of the densest
_SHARE = 0.85  # of the way to that edge


def measure_strokes(bench: Bench, names: Sequence[str]) -> list[Row]:
    """Three strokes on each tree's first view: the share of their length with wood nearby in that view."""
    whole, limbs = {}, {}
    for name in names:
        truth = load_truth(bench.data / "truth" / name)
        strokes = draw_strokes(truth, INPUTS[0])
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


def draw_strokes(truth: Truth, yaw: int) -> list[NDArray[np.float32]]:
    """Bent lines (n, 2) [pixels] from the trunk toward the edge of the crown."""
    camera = truth.cameras[yaw]
    unit = truth.height / camera.metres_per_pixel
    crown = gaussian_filter(truth.alphas[yaw], _BLUR * unit)
    inside = crown > _INSIDE * crown.max()
    strokes = []
    for rise, lean, turn in _BRANCHES:
        at = np.array([camera.foot[0], camera.foot[1] - rise * unit])
        line, count = [at], round(_LONGEST / _STEP)
        for step in range(count):
            angle = np.radians(lean - np.sign(lean) * turn * step / count)
            at = at + _STEP * unit * np.array([np.sin(angle), -np.cos(angle)])
            column, row = (int(n) for n in at)
            if not (0 <= row < inside.shape[0] and 0 <= column < inside.shape[1]):
                break
            line.append(at)
        within = [n for n, (x, y) in enumerate(line) if inside[int(y), int(x)]]
        last = max(2, int(_SHARE * within[-1])) if within else 2
        strokes.append(np.array(line[: last + 1], np.float32))
    return strokes
