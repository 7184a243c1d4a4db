"""How alike trees made from exact mattes are to the known ones, from the inputs and from other sides."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from benchmarks.draw_comparison import draw_comparison
from benchmarks.likeness.bench import Bench, Row, mean
from benchmarks.likeness.show_sheet import show_sheet
from benchmarks.measure_truth import HELD_OUT, INPUTS, Measured, load_truth, mean_over, measure_truth
from flowtree.render.write_picture import write_picture

_INPUTS, _WORST, _HELD_OUT = 0.85, 0.75, 0.604
_YAWS = {"inputs": INPUTS, "held_out": HELD_OUT}


def measure_exact(bench: Bench, names: Sequence[str]) -> list[Row]:
    """Soft IoU of the tree with the known one; ``bench.details`` gets every view's, and the volume's."""
    figures = {}
    for name in names:
        truth = load_truth(bench.data / "truth" / name)
        measured = measure_truth(truth, params=bench.params, cache=bench.cache)
        show_sheet(bench, f"truth_{name}", measured.made)
        if bench.folder is not None:
            write_picture(draw_comparison(truth, measured), bench.folder / f"truth_{name}_around.jpg")
        figures[name] = _figures(measured)
    bench.details["truth"] = figures
    tree, volume = (
        {group: {name: figures[name][of][group] for name in names} for group in _YAWS}
        for of in ("tree", "volume")
    )
    views = {f"{name} {yaw}": figures[name]["tree"][f"yaw_{yaw}"] for name in names for yaw in INPUTS}
    faults = {name: float(len(figures[name]["faults"])) for name in names}
    return [
        Row("known trees, exact mattes: input views", _INPUTS, mean(tree["inputs"]), tree["inputs"]),
        Row("the same, worst tree", _WORST, min(tree["inputs"].values()), views),
        Row("the same, held-out views", _HELD_OUT, mean(tree["held_out"]), tree["held_out"]),
        Row("the volume alone: input views", None, mean(volume["inputs"]), volume["inputs"]),
        Row("the volume alone: held-out views", None, mean(volume["held_out"]), volume["held_out"]),
        Row("faults of these trees", 0.0, sum(faults.values()), faults, at_most=True),
    ]


def _figures(measured: Measured) -> dict[str, Any]:
    """One tree's part of the result: rounded, so that equal trees give equal files."""
    scores = {"tree": measured.of_tree, "volume": measured.of_volume}
    skeleton, foliage = measured.tree.skeleton, measured.tree.foliage
    return {
        **{
            name: {
                **{f"yaw_{yaw}": round(of[yaw], 4) for yaw in sorted(of)},
                **{group: round(mean_over(of, yaws), 4) for group, yaws in _YAWS.items()},
            }
            for name, of in scores.items()
        },
        "particles": int(skeleton.particles[0]),
        "nodes": len(skeleton.parent),
        "triangles": len(measured.tree.wood.triangles),
        "leaves": 0 if foliage is None else len(foliage.position),
        "faults": list(measured.faults),
        "digest": measured.digest,
    }
