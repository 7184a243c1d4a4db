"""A skeleton as a table of cylinders, as TreeQSM and the programs of forest science write them."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from flowtree import check
from flowtree.export.check_skeleton import check_skeleton
from flowtree.export.format_numbers import format_numbers
from flowtree.export.number_branches import number_branches
from flowtree.files import write_whole
from flowtree.model.skeleton import Skeleton

# TreeQSM's columns first, under the names its readers know; then what brings a skeleton back exactly.
COLUMNS = (
    "radius",
    "length",
    "start_x",
    "start_y",
    "start_z",
    "axis_x",
    "axis_y",
    "axis_z",
    "parent",
    "extension",
    "branch",
    "branch_order",
    "position_in_branch",
    "start_radius",
    "end_radius",
    "end_x",
    "end_y",
    "end_z",
    "particles",
    "twig",
)


def write_cylinders_csv(skeleton: Skeleton, path: Path) -> None:
    """Writes a line for every segment, in the order of the nodes they lead to.

    As in TreeQSM, cylinders are counted from 1 and 0 stands for none (so the segment of node i is cylinder
    i), ``parent`` is the cylinder it grows from, ``extension`` the one that carries its branch on,
    ``branch_order`` is 0 in the trunk and ``radius`` the mean of both ends. Metres; unlike TreeQSM's, the y
    axis points up.

    Raises:
        InputError: the skeleton is broken (see `check_skeleton`) or has no segment.
        OutputError: the file could not be written; what stood there is untouched.
    """
    check_skeleton(skeleton)
    count = len(skeleton.parent)
    check.require(
        count > 1, "skeleton", "needs a segment to make a cylinder of", "one node", "use .json or .swc"
    )
    parent = skeleton.parent[1:]
    numbers = number_branches(skeleton)
    start, end = skeleton.points[parent], skeleton.points[1:]
    span = end.astype(np.float64) - start
    length = np.linalg.norm(span, axis=1)
    axis = np.tile(np.array([0.0, 1.0, 0.0]), (count - 1, 1))
    np.divide(span, length[:, None], out=axis, where=length[:, None] > 0)
    thin, thick = skeleton.radius[1:], skeleton.radius[parent]
    columns = [
        ((thin.astype(np.float64) + thick) / 2).astype(np.float32),
        length.astype(np.float32),
        *start.T,
        *axis.astype(np.float32).T,
        parent,
        np.maximum(numbers.extension[1:], 0),
        numbers.branch[1:],
        skeleton.level[1:],
        numbers.position[1:],
        thick,
        thin,
        *end.T,
        skeleton.particles[1:],
        skeleton.twig[1:],
    ]
    rows = zip(*(format_numbers(column) for column in columns), strict=True)
    lines = [",".join(COLUMNS), *(",".join(row) for row in rows)]
    write_whole(path, ("\n".join(lines) + "\n").encode())
