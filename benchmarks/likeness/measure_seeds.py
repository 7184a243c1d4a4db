"""Whether other seeds make other trees that are as alike."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from benchmarks.likeness.bench import Bench, Row
from benchmarks.likeness.make_known import make_known, see_alpha
from benchmarks.measure_truth import INPUTS, load_truth
from flowtree.render.soft_iou import soft_iou

_ASKED = 0.03
_SEEDS = (0, 1, 2)


def measure_seeds(bench: Bench, names: Sequence[str]) -> list[Row]:
    """Exact mattes, three seeds: skeletons that are equal, and by how much soft IoU at the inputs varies."""
    spread, equal = {}, {}
    for name in names:
        truth = load_truth(bench.data / "truth" / name)
        scores, skeletons = [], set()
        for seed in _SEEDS:
            made = make_known(bench, truth, seed=seed)
            skeletons.add(made.skeleton.points.tobytes())
            each = []
            for yaw in INPUTS:
                camera = truth.cameras[yaw]
                seen = see_alpha(made, truth, yaw)
                each.append(soft_iou(seen, camera, truth.alphas[yaw], camera, height=truth.height))
            scores.append(float(np.mean(each)))
        spread[name] = max(scores) - min(scores)
        equal[name] = float(len(_SEEDS) - len(skeletons))
    return [
        Row("other seeds: soft IoU varies by, at most", _ASKED, max(spread.values()), spread, at_most=True),
        Row("other seeds: equal skeletons", 0.0, sum(equal.values()), equal, at_most=True),
    ]
