"""A skeleton as PLY: its nodes as points, its segments as edges."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from flowtree import __version__
from flowtree.export.check_skeleton import check_skeleton
from flowtree.files import write_whole
from flowtree.model.skeleton import Skeleton


def write_skeleton_ply(skeleton: Skeleton, path: Path) -> None:
    """Writes a binary PLY with the elements ``vertex`` (place, radius, …) and ``edge`` (parent, child).

    Metres, y up.

    Raises:
        InputError: the skeleton is broken (see `check_skeleton`).
        OutputError: the file could not be written; what stood there is untouched.
    """
    check_skeleton(skeleton)
    count = len(skeleton.parent)
    kinds = {"x": "f4", "y": "f4", "z": "f4", "radius": "f4", "particles": "i4", "level": "i4", "twig": "u1"}
    nodes = np.empty(count, [(name, f"<{kind}") for name, kind in kinds.items()])
    for column, name in enumerate("xyz"):
        nodes[name] = skeleton.points[:, column]
    for name in ("radius", "particles", "level", "twig"):
        nodes[name] = getattr(skeleton, name)
    edges = np.stack([skeleton.parent[1:], np.arange(1, count)], axis=1).astype("<i4")
    words = {"f4": "float", "i4": "int", "u1": "uchar"}
    head = [
        "ply",
        "format binary_little_endian 1.0",
        f"comment flowtree {__version__} skeleton, metres, y up",
        f"element vertex {count}",
        *(f"property {words[kind]} {name}" for name, kind in kinds.items()),
        f"element edge {count - 1}",
        "property int vertex1",
        "property int vertex2",
        "end_header",
    ]
    write_whole(path, ("\n".join(head) + "\n").encode() + nodes.tobytes() + edges.tobytes())
