"""A table of cylinders to a skeleton."""

from __future__ import annotations

import csv
import io
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flowtree import check
from flowtree.export.assemble_skeleton import assemble_skeleton
from flowtree.model.skeleton import Skeleton

_START, _AXIS, _END = ([f"{word}_{axis}" for axis in "xyz"] for word in ("start", "axis", "end"))
_NEEDED = ["radius", "length", *_START, *_AXIS, "parent"]
_OURS = ["start_radius", "end_radius", *_END, "particles"]
_OPTIONAL = ["branch_order", "twig"]
# Roots of one tree start where the table's rounding puts them, not exactly at one point.
_ROOT_METRES = 1e-3


def parse_cylinders_csv(name: str, text: str) -> Skeleton:
    """Reads a table of cylinders: node 0 is the foot, node i the end of cylinder i.

    Columns are found by name, whatever their case and underscores; others may hold anything. A table of
    another program has no radii of both ends: there a node gets that of the cylinder that ends in it.

    Args:
        name: the file's, for the error.
        text: its content; cylinders counted from 1, parent 0 for none; metres, y up.

    Raises:
        InputError: a column or number is missing, or it is no single tree.
    """
    table = _read_columns(name, text)
    start, up = _rows(table, _START), table["parent"].astype(np.int64)
    first = np.flatnonzero(up == 0)
    check.require(len(first) > 0, name, "must have a cylinder without parent", "none", "set its parent to 0")
    apart = float(np.abs(start[first] - start[first[0]]).max())
    rule = "must hold one tree: all cylinders without parent start at one point"
    check.require(apart <= _ROOT_METRES, name, rule, f"starts {apart:g} m apart", "keep one tree")
    if all(word in table for word in _OURS):
        end, radius, foot = _rows(table, _END), table["end_radius"], table["start_radius"][first].max()
        particles = table["particles"].astype(np.int64)
        counts = np.concatenate([particles[first].sum(keepdims=True), particles])
    else:
        end = start + table["length"][:, None] * _rows(table, _AXIS)
        radius, foot, counts = table["radius"], table["radius"][first].max(), None
    level, twig = (
        np.concatenate([[0], table[word].astype(np.int64)]) if word in table else None for word in _OPTIONAL
    )
    return assemble_skeleton(
        name,
        np.concatenate([[-1], up]),
        np.concatenate([start[first[:1]], end]),
        np.concatenate([[foot], radius]),
        particles=counts,
        level=level,
        twig=twig,
    )


def _read_columns(name: str, text: str) -> dict[str, NDArray[np.float64]]:
    """The columns whose names we know, (n,) each."""
    try:
        head, *lines = list(csv.reader(io.StringIO(text))) or [[]]
    except csv.Error as error:
        check.fail(name, "must be a table of comma-separated numbers", str(error), "repair the file")
    places = {_plain(word): k for k, word in enumerate(head)}
    known = [*_NEEDED, *_OURS, *_OPTIONAL]
    place = {word: places[_plain(word)] for word in known if _plain(word) in places}
    missing = ", ".join(word for word in _NEEDED if word not in place)
    check.require(
        not missing, name, f"needs the columns {', '.join(_NEEDED)}", f"none for {missing}", "add them"
    )
    rows: list[list[float]] = []
    for number, line in enumerate(lines, 2):
        if not line:
            continue
        try:
            rows.append([float(line[k]) for k in place.values()])
        except (ValueError, IndexError):
            got = repr(",".join(line)[:60])
            check.fail(
                f"{name}, line {number}", "must hold a number in every column", got, "repair that line"
            )
    check.require(bool(rows), name, "needs a cylinder", "none", "choose a file with a skeleton")
    shape = (None, len(place))
    values = check.array(np.array(rows), name, shape=shape, dtype=np.float64, low=-1e15, high=1e15)
    return dict(zip(place, values.T, strict=True))


def _plain(word: str) -> str:
    return "".join(c for c in word.lower() if c.isalnum())


def _rows(table: dict[str, NDArray[Any]], words: list[str]) -> NDArray[np.float64]:
    return np.stack([table[word] for word in words], axis=1)
