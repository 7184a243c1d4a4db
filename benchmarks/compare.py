"""Puts two reports side by side: medians, their ratio, and whether the spreads overlap."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

from benchmarks.cases import Case, read_report

_Key = tuple[str, int, str]


def main(argv: list[str]) -> int:
    """Prints a line for each case, size and program that either report holds."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks compare", description=__doc__)
    parser.add_argument("before", type=Path, metavar="A.json")
    parser.add_argument("after", type=Path, metavar="B.json")
    options = parser.parse_args(argv)
    (machine, before), (other, after) = read_report(options.before), read_report(options.after)
    _print(_by_key(before), _by_key(after))
    for line in _differences(machine, other):
        print(line)
    return 0


def _by_key(cases: list[Case]) -> dict[_Key, Case]:
    return {(case.case, case.size, case.program): case for case in cases}


def _print(before: dict[_Key, Case], after: dict[_Key, Case]) -> None:
    table = Table()
    for name in ("case", "size", "program", "A [s]", "B [s]", "B / A", "spreads"):
        table.add_column(name, justify="left" if name in {"case", "program", "spreads"} else "right")
    for key in dict.fromkeys([*before, *after]):
        a, b = before.get(key), after.get(key)
        table.add_row(key[0], f"{key[1]}", key[2], _seconds(a), _seconds(b), *_judge(a, b))
    Console(width=110, markup=False, emoji=False).print(table)


def _seconds(case: Case | None) -> str:
    if case is None:
        return "-"
    return f"{case.median_s:.3g}" if case.valid else "wrong"


def _judge(a: Case | None, b: Case | None) -> tuple[str, str]:
    """Ratio of the medians, and what the spreads (fastest to slowest run) say about it."""
    if a is None or b is None:
        return "-", "only in B" if a is None else "only in A"
    if not (a.valid and b.valid):
        return "-", "not timed"
    overlap = a.min_s <= b.max_s and b.min_s <= a.max_s
    ratio = f"{b.median_s / a.median_s:.2f}" if a.median_s > 0 else "-"
    return ratio, "overlap" if overlap else "B is faster" if b.max_s < a.min_s else "B is slower"


def _differences(machine: dict[str, Any], other: dict[str, Any]) -> list[str]:
    """A line for each thing in which the machines differ: times from two machines are no comparison."""
    names = [name for name in {**machine, **other} if name != "date"]
    return [
        f"not the same {name}: {machine.get(name)} and {other.get(name)}"
        for name in names
        if machine.get(name) != other.get(name)
    ]
