"""Skeletons back from files, ours and other programs'."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from flowtree import check
from flowtree.export.parse_cylinders_csv import parse_cylinders_csv
from flowtree.export.parse_skeleton_json import parse_skeleton_json
from flowtree.export.parse_swc import parse_swc
from flowtree.model.skeleton import Skeleton


def read_skeleton(path: Path) -> Skeleton:
    """Reads a skeleton from ``.swc``, ``.csv`` (cylinders) or ``.json`` (our own), by the file's ending.

    What the file does not hold is derived (see `assemble_skeleton`): branching order and particle counts in
    SWC, the root's particles in CSV. Nodes may come in any order. Axes are taken as they are: y must be up.

    Raises:
        InputError: the file cannot be read, has another ending, is malformed, or holds no single tree.
    """
    readers: dict[str, Callable[[str, str], Skeleton]] = {
        ".swc": parse_swc,
        ".csv": parse_cylinders_csv,
        ".json": parse_skeleton_json,
    }
    ending = path.suffix.lower()
    check.require(
        ending in readers, path.name, f"must end in {', '.join(readers)}", ending or "no ending", "convert it"
    )
    try:
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else "bytes that are no text"
        check.fail(path.name, "must be a readable text file", reason, "choose another file")
    return readers[ending](path.name, text)
