"""A skeleton as SWC, the neuroscientists' text format for branching cables."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from flowtree import __version__
from flowtree.export.check_skeleton import check_skeleton
from flowtree.export.format_numbers import format_numbers
from flowtree.files import write_whole
from flowtree.model.skeleton import Skeleton

# SWC's kinds of node: 0 is "undefined", 7 "custom".
TRACED, TWIG = 0, 7


def write_swc(skeleton: Skeleton, path: Path) -> None:
    """Writes a line ``id kind x y z radius parent`` for every node, counted from 1; the root's parent is -1.

    The coordinates stay as they are, metres with y up, which the file's head says: SWC itself fixes neither.
    Branching order and particle counts have no place in the format.

    Raises:
        InputError: the skeleton is broken (see `check_skeleton`).
        OutputError: the file could not be written; what stood there is untouched.
    """
    check_skeleton(skeleton)
    lines = [
        f"# flowtree {__version__}",
        "# x y z radius in metres, y up, right-handed; the foot of the trunk is the root",
        f"# kind {TRACED}: traced, kind {TWIG}: a twig placed by rule",
        "# id kind x y z radius parent",
    ]
    kinds = np.where(skeleton.twig, TWIG, TRACED).tolist()
    parents = np.where(skeleton.parent >= 0, skeleton.parent + 1, -1).tolist()
    points, radii = format_numbers(skeleton.points), format_numbers(skeleton.radius)
    for k, (kind, (x, y, z), radius, up) in enumerate(zip(kinds, points, radii, parents, strict=True)):
        lines.append(f"{k + 1} {kind} {x} {y} {z} {radius} {up}")
    write_whole(path, ("\n".join(lines) + "\n").encode())
