"""Measures how alike trees are to the photographs and the known trees that they are made from."""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from benchmarks.describe_machine import describe_machine
from benchmarks.likeness.bench import Bench, Row
from benchmarks.likeness.parts import PARTS
from benchmarks.likeness.write_table import markdown_table, print_table
from flowtree import check
from flowtree.configuration import override_params
from flowtree.files import write_whole
from flowtree.params import Params

_DATA = Path(__file__).parents[1] / ".." / "shared" / "data"


def main(argv: list[str]) -> int:
    """Measures, prints, and returns 0 where every bound is kept."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks fidelity", description=__doc__)
    parser.add_argument("--data", type=Path, default=_DATA, help="the folder of known trees and photographs")
    parser.add_argument("--part", nargs="+", metavar="NAME", help=f"only these: {', '.join(PARTS)}")
    parser.add_argument("--tree", nargs="+", metavar="NAME", help="only these trees and photographs")
    parser.add_argument(
        "--set", nargs="+", default=[], metavar="NAME=VALUE", help="parameters, to see what they change"
    )
    parser.add_argument("--json", type=Path, metavar="FILE", help="the same numbers as a file")
    parser.add_argument("-o", "--output", type=Path, metavar="DIR", help="fidelity.md and contact sheets")
    options = parser.parse_args(argv)
    chosen = _choose(options.part, options.data, options.tree)
    folder = options.output
    if folder is not None:
        folder.mkdir(parents=True, exist_ok=True)
    params = override_params(Params(), options.set)
    bench = Bench(options.data, params, folder=folder)
    rows: dict[str, list[Row]] = {}
    for part, names in chosen.items():
        start = time.perf_counter()
        rows[part] = PARTS[part].measure(bench, names)
        print(f"fidelity.{part}.all {time.perf_counter() - start:.1f} s", flush=True)
    machine = describe_machine()
    passed = all(row.passed for measured in rows.values() for row in measured)
    if options.json is not None:
        write_whole(
            options.json, (json.dumps(_as_json(rows, bench, machine, passed), indent=2) + "\n").encode()
        )
    if folder is not None:
        write_whole(folder / "fidelity.md", markdown_table(rows, machine).encode())
    print_table(rows)
    print(machine)
    print("passed" if passed else "not passed")
    return 0 if passed else 1


def _choose(parts: Sequence[str] | None, data: Path, trees: Sequence[str] | None) -> dict[str, list[str]]:
    """The names to measure of each part; a part that has none of the wanted ones is left out."""
    for part in parts or ():
        check.require(part in PARTS, part, "must be a part", "another name", check.nearest_name(part, PARTS))
    known = {part: PARTS[part].find(data) for part in PARTS if not parts or part in parts}
    every = {name for names in known.values() for name in names}
    for tree in trees or ():
        check.require(
            tree in every, tree, "must be a known tree", "another name", check.nearest_name(tree, every)
        )
    wanted = every if not trees else set(trees)
    chosen = {part: [name for name in names if name in wanted] for part, names in known.items()}
    return {part: names for part, names in chosen.items() if names}


def _as_json(rows: dict[str, list[Row]], bench: Bench, machine: str, passed: bool) -> dict[str, Any]:
    """Rounded, so that equal trees give equal files."""
    parts = {
        part: [
            {
                **asdict(row),
                "reached": round(row.reached, 4),
                "items": {name: round(value, 4) for name, value in row.items.items()},
                "passed": row.passed,
            }
            for row in measured
        ]
        for part, measured in rows.items()
    }
    return {"machine": machine, "parts": parts, **bench.details, "passed": passed}
