"""SWC text to a skeleton."""

from __future__ import annotations

import numpy as np

from flowtree import check
from flowtree.export.assemble_skeleton import assemble_skeleton
from flowtree.export.write_swc import TWIG
from flowtree.model.skeleton import Skeleton


def parse_swc(name: str, text: str) -> Skeleton:
    """Reads lines ``id kind x y z radius parent``; ``#`` begins a comment, any negative parent is the root's.

    Args:
        name: the file's, for the error.
        text: its content; metres, y up.

    Raises:
        InputError: a line is malformed, an id comes twice, a parent is missing, or it is no single tree.
    """
    ids: list[int] = []
    ups: list[int] = []
    rows: list[list[float]] = []
    twig: list[bool] = []
    for number, line in enumerate(text.splitlines(), 1):
        words = line.split("#", 1)[0].split()
        if not words:
            continue
        try:
            node, kind, *values = words[:6]
            ids.append(int(node))
            twig.append(int(kind) == TWIG)
            rows.append([float(value) for value in values])
            ups.append(int(words[6]))
        except (ValueError, IndexError):
            rule = "must be: id kind x y z radius parent"
            check.fail(f"{name}, line {number}", rule, repr(line[:60]), "repair that line")
    index = {node: k for k, node in enumerate(ids)}
    check.require(len(index) == len(ids), name, "must number every node once", "a number twice", "renumber")
    unknown = next((up for up in ups if up >= 0 and up not in index), None)
    check.require(unknown is None, name, "must name parents it holds", f"parent {unknown}", "add that node")
    table = np.array(rows, np.float64).reshape(-1, 4)
    parent = [index[up] if up >= 0 else -1 for up in ups]
    return assemble_skeleton(name, parent, table[:, :3], table[:, 3], twig=twig)
