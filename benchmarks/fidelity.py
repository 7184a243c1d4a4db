"""Measures how alike trees made from known trees are to them, at the input and at held-out views."""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

from benchmarks.describe_machine import describe_machine
from benchmarks.draw_comparison import draw_comparison
from benchmarks.measure_truth import HELD_OUT, INPUTS, Measured, load_truth, mean_over, measure_truth
from flowtree import check
from flowtree.files import write_whole
from flowtree.render.write_picture import write_picture

#: The project's own bounds: means over all trees that must be reached.
TARGETS = {"inputs": 0.70, "held_out": 0.55}

_DATA = Path(__file__).parents[1] / ".." / "shared" / "data"
_YAWS = {"inputs": INPUTS, "held_out": HELD_OUT}


def main(argv: list[str]) -> int:
    """Measures, prints, and returns 0 where all trees are valid and the means reach `TARGETS`."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks fidelity", description=__doc__)
    parser.add_argument("--data", type=Path, default=_DATA, help="the folder that holds truth/")
    parser.add_argument("--tree", nargs="+", metavar="NAME", help="only these trees")
    parser.add_argument("--json", type=Path, metavar="FILE", help="the same numbers as a file")
    parser.add_argument("-o", "--output", type=Path, metavar="DIR", help="a picture of each tree")
    options = parser.parse_args(argv)
    names = _choose(options.data / "truth", options.tree)
    if options.output is not None:
        options.output.mkdir(parents=True, exist_ok=True)
    figures: dict[str, dict[str, Any]] = {}
    for name in names:
        truth = load_truth(options.data / "truth" / name)
        start = time.perf_counter()
        measured = measure_truth(truth)
        figures[name] = _figures(measured)
        print(f"fidelity.{name}.stages {measured.seconds:.1f} s", flush=True)
        print(f"fidelity.{name}.all {time.perf_counter() - start:.1f} s", flush=True)
        if options.output is not None:
            write_picture(draw_comparison(truth, measured), options.output / f"{name}.png")
    result = _sum_up(figures)
    if options.json is not None:
        write_whole(options.json, (json.dumps(result, indent=2) + "\n").encode())
    _print(result)
    return 0 if result["passed"] else 1


def _choose(folder: Path, wanted: list[str] | None) -> list[str]:
    """The trees to measure."""
    known = sorted(file.parent.name for file in folder.glob("*/truth.json"))
    check.require(
        bool(known), str(folder), "must hold NAME/truth.json", "none", "name the data folder with --data"
    )
    for name in wanted or ():
        check.require(
            name in known, name, "must be a known tree", "another name", check.nearest_name(name, known)
        )
    return known if not wanted else list(dict.fromkeys(wanted))


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


def _sum_up(figures: dict[str, dict[str, Any]]) -> dict[str, Any]:
    """All trees, their means, and whether those suffice."""
    keys = [*(f"yaw_{yaw}" for yaw in sorted(INPUTS + HELD_OUT)), *_YAWS]
    mean = {
        of: {key: round(sum(tree[of][key] for tree in figures.values()) / len(figures), 4) for key in keys}
        for of in ("tree", "volume")
    }
    reached = all(mean["tree"][group] >= least for group, least in TARGETS.items())
    valid = not any(tree["faults"] for tree in figures.values())
    return {
        "machine": describe_machine(),
        "trees": figures,
        "mean": mean,
        "targets": TARGETS,
        "passed": reached and valid,
    }


def _print(result: dict[str, Any]) -> None:
    table = Table(title="Soft IoU with the known tree (behind it: of the density volume alone)")
    table.add_column("tree")
    for yaw in sorted(INPUTS + HELD_OUT):
        table.add_column(f"{yaw}°" + ("" if yaw in INPUTS else " held out"), justify="right")
    for group in _YAWS:
        table.add_column(group.replace("_", " "), justify="right", style="bold")
    rows = {**result["trees"], "mean": result["mean"]}
    for name, of in rows.items():
        if name == "mean":
            table.add_section()
        table.add_row(name, *(f"{of['tree'][key]:.3f} ({of['volume'][key]:.3f})" for key in of["tree"]))
    empty = [""] * len(INPUTS + HELD_OUT)
    table.add_row("asked", *empty, *(f">= {least:.2f}" for least in TARGETS.values()))
    Console(width=110).print(table)
    for name, tree in result["trees"].items():
        for fault in tree["faults"]:
            print(f"fidelity.{name}.fault {fault}")
    print(result["machine"])
    print("passed" if result["passed"] else "not passed")
