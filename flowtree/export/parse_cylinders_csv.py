"""A table of cylinders to a skeleton."""

from __future__ import annotations

import csv
import io
from typing import Any

import numpy as np

from flowtree import check
from flowtree.export.assemble_skeleton import assemble_skeleton
from flowtree.model.skeleton import Skeleton


def parse_cylinders_csv(name: str, text: str) -> Skeleton:
    """Reads a table of cylinders: node 0 is the foot, node i the end of cylinder i.

    Columns are found by name, whatever their case and underscores. A table of another program has no radii of
    both ends: there a node gets the radius of the cylinder that ends in it.

    Args:
        name: the file's, for the error.
        text: its content; cylinders counted from 1, parent 0 for none; metres, y up.

    Raises:
        InputError: a column or number is missing, or it is no single tree.
    """
    try:
        lines = list(csv.reader(io.StringIO(text)))
    except csv.Error as error:
        check.fail(name, "must be a table of comma-separated numbers", str(error), "repair the file")
    head = ["".join(c for c in word.lower() if c.isalnum()) for word in lines[0]] if lines else []
    column = {word: k for k, word in enumerate(head)}
    needed = ["radius", "length", *_axes("start"), *_axes("axis"), "parent"]
    missing = [word for word in needed if word not in column]
    check.require(
        not missing,
        name,
        f"needs the columns {', '.join(needed)}",
        f"none for {', '.join(missing)}",
        "add them",
    )
    rows: list[list[float]] = []
    for number, line in enumerate(lines[1:], 2):
        if not line:
            continue
        try:
            row = [float(word) for word in line]
        except ValueError:
            row = []
        got, place = repr(",".join(line)[:60]), f"{name}, line {number}"
        check.require(len(row) == len(head), place, f"must hold {len(head)} numbers", got, "repair that line")
        rows.append(row)
    check.require(bool(rows), name, "needs a cylinder", "none", "choose a file with a skeleton")
    table = check.array(np.array(rows), name, shape=(None, len(head)), dtype=np.float64, low=-1e15, high=1e15)

    def read(*words: str) -> Any:
        return table[:, [column[word] for word in words]]

    start, up = read(*_axes("start")), read("parent")[:, 0].astype(np.int64)
    first = np.flatnonzero(up == 0)
    check.require(len(first) > 0, name, "must have a cylinder without parent", "none", "set its parent to 0")
    apart = float(np.abs(start[first] - start[first[0]]).max())
    check.require(
        apart <= 1e-3,
        name,
        "must hold one tree: all cylinders without parent start at one point",
        f"starts {apart:g} m apart",
        "keep one tree",
    )
    own = all(word in column for word in ("startradius", "endradius", *_axes("end"), "particles"))
    end = read(*_axes("end")) if own else start + read("length") * read(*_axes("axis"))
    radius = read("endradius" if own else "radius")[:, 0]
    foot = read("startradius" if own else "radius")[first, 0].max()
    more = {}
    if own:
        particles = read("particles")[:, 0].astype(np.int64)
        more["particles"] = np.concatenate([[particles[first].sum()], particles])
    for word, array in (("branchorder", "level"), ("twig", "twig")):
        if word in column:
            more[array] = np.concatenate([[0], read(word)[:, 0].astype(np.int64)])
    return assemble_skeleton(
        name,
        np.concatenate([[-1], up]),
        np.concatenate([start[first[:1]], end]),
        np.concatenate([[foot], radius]),
        **more,
    )


def _axes(word: str) -> list[str]:
    return [f"{word}{axis}" for axis in "xyz"]
