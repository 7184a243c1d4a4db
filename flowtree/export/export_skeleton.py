"""Skeletons into the format that the file's ending names."""

from __future__ import annotations

from pathlib import Path

from flowtree import check
from flowtree.export.write_cylinders_csv import write_cylinders_csv
from flowtree.export.write_skeleton_json import write_skeleton_json
from flowtree.export.write_skeleton_ply import write_skeleton_ply
from flowtree.export.write_swc import write_swc
from flowtree.model.skeleton import Skeleton

_WRITERS = {
    ".swc": write_swc,
    ".csv": write_cylinders_csv,
    ".ply": write_skeleton_ply,
    ".json": write_skeleton_json,
}
SKELETON_ENDINGS = tuple(_WRITERS)


def export_skeleton(skeleton: Skeleton, path: Path) -> None:
    """Writes a skeleton as ``.swc``, ``.csv`` (cylinders), ``.ply`` (points and edges) or ``.json``.

    Raises:
        InputError: another ending, or a broken skeleton.
        OutputError: the file could not be written; what stood there is untouched.
    """
    ending = path.suffix.lower()
    rule = f"must end in {', '.join(SKELETON_ENDINGS)}"
    check.require(ending in _WRITERS, f"skeleton {path.name}", rule, ending or "no ending", "rename it")
    _WRITERS[ending](skeleton, path)
