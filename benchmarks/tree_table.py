"""A table in Markdown with a row for every tree of the data, for what is measured of finished trees."""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from benchmarks.describe_machine import describe_machine
from benchmarks.likeness.bench import find_cutouts, find_photographs, find_truth
from benchmarks.matted_pair import HEIGHT, PAIR
from flowtree import check
from flowtree.files import write_whole
from flowtree.pipeline.reconstruct import Reconstruction, reconstruct

_DATA = Path(__file__).parents[1] / ".." / "shared" / "data"


class TreeTable:
    """Prints rows as they come.

    Attributes:
        rows: dataclasses that were added.
    """

    def __init__(self, head: Sequence[tuple[str, str]], cell: Callable[[Any], str]) -> None:
        """Prints the head: (field of a row, title) of each column; ``cell`` writes a field's value."""
        self._head, self._cell = head, cell
        self.rows: list[Any] = []
        print("| " + " | ".join(title for _, title in head) + " |")
        print("|---|" + "---:|" * (len(head) - 1), flush=True)

    def add(self, row: Any) -> None:
        """Prints a row."""
        self.rows.append(row)
        print("| " + " | ".join(self._cell(getattr(row, key)) for key, _ in self._head) + " |", flush=True)

    def end(self, file: Path | None) -> None:
        """Prints what it was measured on, and writes all into a file where one is asked for."""
        machine = describe_machine()
        print(machine)
        if file is not None:
            report = {"machine": machine, "trees": [asdict(row) for row in self.rows]}
            write_whole(file, (json.dumps(report, indent=2) + "\n").encode())


def add_options(parser: argparse.ArgumentParser) -> None:
    """Which trees, and where to write the numbers."""
    parser.add_argument("--data", type=Path, default=_DATA, help="the folder of known trees and photographs")
    parser.add_argument("--tree", nargs="+", metavar="NAME", help="only these; demo is the bundled pair")
    parser.add_argument("--json", type=Path, metavar="FILE", help="the same numbers as a file")


def make_trees(options: argparse.Namespace) -> Iterator[tuple[str, Reconstruction]]:
    """Makes the trees that were asked for, one after the other.

    Raises:
        InputError: a name of no tree.
    """
    known = find_trees(options.data)
    for name in options.tree or ():
        check.require(
            name in known, name, "must be a known tree", "another name", check.nearest_name(name, known)
        )

    def make(name: str) -> Reconstruction:
        photos, yaws = known[name]
        return reconstruct(photos, yaws=yaws, height=HEIGHT if name == "demo" else None)

    return ((name, make(name)) for name in options.tree or known)


def find_trees(data: Path) -> dict[str, tuple[list[Path], list[float] | None]]:
    """Photographs and yaws by name: the demo, and all that the data folder holds where there is one."""
    found: dict[str, tuple[list[Path], list[float] | None]] = {"demo": (list(PAIR), [0.0, 90.0])}
    if data.is_dir():
        for name in find_truth(data):
            folder = data / "truth" / name
            found[name] = ([folder / "ortho_000.png", folder / "ortho_090.png"], [0.0, 90.0])
        for name in find_cutouts(data):
            found[name] = ([data / "cutouts" / f"{name}.png"], None)
        for name in find_photographs(data):
            found[name] = ([data / "photos" / f"{name}.jpg"], None)
    return found
