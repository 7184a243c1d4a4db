"""How alike trees made from loose photographs are to the known ones, from four sides."""

from __future__ import annotations

from collections.abc import Sequence

from benchmarks.likeness.bench import Bench, Row, mean
from benchmarks.likeness.make_known import see_alpha
from benchmarks.likeness.show_sheet import show_sheet
from benchmarks.measure_truth import INPUTS, load_truth
from flowtree.pipeline.reconstruct import reconstruct
from flowtree.render.soft_iou import soft_iou

_ASKED = 0.60


def measure_loose(bench: Bench, names: Sequence[str]) -> list[Row]:
    """Photographs from rough yaws, automatic mattes, the height given; all four parallel views count."""
    scores, means = {}, {}
    for name in names:
        truth = load_truth(bench.data / "truth" / name)
        files = [bench.data / "truth" / name / f"photo_{number}.jpg" for number in range(len(INPUTS))]
        made = reconstruct(files, yaws=INPUTS, height=truth.height, params=bench.params, cache=bench.cache)
        show_sheet(bench, f"loose_{name}", made)
        each = {}
        for yaw, camera in truth.cameras.items():
            seen = see_alpha(made, truth, yaw)
            each[f"{name} {yaw}"] = soft_iou(seen, camera, truth.alphas[yaw], camera, height=truth.height)
        scores.update(each)
        means[name] = mean(each)
    return [
        Row("known trees, loose photos: all four views", _ASKED, mean(scores), scores),
        Row("the same, a tree each", None, min(means.values()), means),
    ]
