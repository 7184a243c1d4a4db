"""Whether the limbs of known trees stand where the true ones do."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from benchmarks.likeness.bench import Bench, Row, mean
from benchmarks.likeness.load_stems import load_stems
from benchmarks.likeness.make_known import make_known
from benchmarks.likeness.wood_nearby import Samples, sample_lines, sample_wood, share_near
from benchmarks.measure_truth import INPUTS, load_truth

_ASKED = 0.8
_THICK, _NEAR = 0.008, 0.015  # diameter of a stem that counts, and how near is there [tree heights]


def measure_wood(bench: Bench, names: Sequence[str]) -> list[Row]:
    """Recall and precision of thick stems in the input views, over all lengths of both views.

    Recall: true stems thicker than the bound that have wood of the made tree nearby. Precision: the made
    tree's wood that thick that has a true stem nearby. Among many twigs something is always near: beside the
    asked figures stand those in which only wood counts that is at least half as thick. Leafy trees, whose
    limbs no picture shows, are only told.
    """
    bare, leafy = {}, {}
    for name in names:
        truth = load_truth(bench.data / "truth" / name)
        lines, bears = load_stems(bench.data / "truth" / name)
        stems = _sample_stems(lines, truth.height)
        made = make_known(bench, truth)
        wood = sample_wood(made.skeleton, truth.height, twigs=True)
        (leafy if bears else bare)[name] = _compare(stems, wood, truth.height)
    rows = []
    for of, trees in (("bare trees", bare), ("leafy trees", leafy)):
        for figure in ("recall", "precision", "strict recall", "strict precision"):
            items = {name: figures[figure] for name, figures in trees.items()}
            asked = _ASKED if of == "bare trees" and "strict" not in figure else None
            if items:
                rows.append(Row(f"{of}, thick stems: {figure}", asked, mean(items), items))
    return rows


def _sample_stems(lines: Sequence[NDArray[np.float64]], height: float) -> Samples:
    """Places along the true stems, each a polyline of x, y, z, radius [m]."""
    start, end = (np.concatenate([line[part] for line in lines]) for part in (slice(-1), slice(1, None)))
    radii = np.stack([start[:, 3], end[:, 3]], axis=1)
    return sample_lines(start[:, :3], end[:, :3], radii, height)


def _compare(stems: Samples, wood: Samples, height: float) -> dict[str, float]:
    least, reach = _THICK * height / 2, _NEAR * height
    shares: dict[str, list[float]] = {}
    for yaw in INPUTS:
        true, made = stems.seen_from(yaw), wood.seen_from(yaw)
        for figure, lines, others in (("recall", true, made), ("precision", made, true)):
            thick = lines.at_least(least)
            shares.setdefault(figure, []).append(share_near(thick, others, reach))
            strict = share_near(thick, others.at_least(least / 2), reach)
            shares.setdefault(f"strict {figure}", []).append(strict)
    return {figure: float(np.mean(each)) for figure, each in shares.items()}
