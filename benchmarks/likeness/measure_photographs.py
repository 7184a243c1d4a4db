"""How alike trees made from single photographs are to their mattes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from benchmarks.likeness.bench import Bench, Row
from benchmarks.likeness.show_sheet import show_sheet
from flowtree.pipeline.reconstruct import reconstruct

_ASKED = 0.80


def measure_photographs(bench: Bench, names: Sequence[str]) -> list[Row]:
    """Each photograph with its mirror image: soft IoU of the tree with the photograph's own matte."""
    scores = {}
    for name in names:
        made = reconstruct([bench.data / "photos" / f"{name}.jpg"], params=bench.params, cache=bench.cache)
        show_sheet(bench, f"photo_{name}", made)
        scores[name] = float(np.mean([view["soft_iou"] for view in made.report["views"]]))
    return [Row("photographs with their mirror image: worst", _ASKED, min(scores.values()), scores)]
