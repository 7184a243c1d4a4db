"""What a file of ours, or another program's, holds."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from flowtree import check
from flowtree.export.inspect_glb import inspect_glb
from flowtree.export.inspect_mesh import inspect_mesh
from flowtree.export.inspect_skeleton import inspect_skeleton
from flowtree.export.inspect_usd import inspect_usd

_INSPECTORS = {
    ".glb": inspect_glb,
    ".obj": inspect_mesh,
    ".ply": inspect_mesh,
    ".usda": inspect_usd,
    ".usdc": inspect_usd,
    ".usdz": inspect_usd,
    ".swc": inspect_skeleton,
    ".csv": inspect_skeleton,
    ".json": inspect_skeleton,
}


def inspect_file(path: Path) -> dict[str, Any]:
    """Lists what a tree or skeleton file holds, as plain data for JSON.

    Returns: see `inspect_glb`, `inspect_mesh`, `inspect_usd` and `inspect_skeleton`; always with "kind",
        "bytes", "bounds".

    Raises:
        InputError: another ending, or a file that cannot be read or is damaged.
    """
    ending = path.suffix.lower()
    rule = f"must end in {', '.join(_INSPECTORS)}"
    check.require(ending in _INSPECTORS, path.name, rule, ending or "no ending", "choose such a file")
    return _INSPECTORS[ending](path)
