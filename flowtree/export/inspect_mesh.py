"""What an OBJ or PLY file holds."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from flowtree import check


def inspect_mesh(path: Path) -> dict[str, Any]:
    """Reads an OBJ or PLY with trimesh and lists what is in it.

    Returns: ``{"kind", "bytes", "meshes": [{"name", "triangles", "vertices"}], "triangles", "bounds": {"min",
        "max"} [m] or None}``; a skeleton's PLY is a mesh of its nodes, without triangles.

    Raises:
        InputError: it cannot be read.
    """
    import trimesh  # half a second to load, and most files need no trimesh

    check.require(path.is_file(), path.name, "must be a readable file", "none", "choose another file")
    try:
        scene = trimesh.load_scene(path, process=False)
    except Exception as error:  # readers of loose formats raise whatever they stumble over
        reason = f"{type(error).__name__}: {str(error)[:80]}"
        check.fail(path.name, "must be a well-formed file", reason, "export it again")
    meshes = [
        {
            "name": str(name),
            "triangles": len(getattr(part, "faces", ())),
            "vertices": len(getattr(part, "vertices", ())),
        }
        for name, part in scene.geometry.items()
    ]
    bounds = None
    if scene.bounds is not None:
        low, high = np.round(scene.bounds, 6).tolist()
        bounds = {"min": low, "max": high}
    return {
        "kind": path.suffix.lower().lstrip("."),
        "bytes": path.stat().st_size,
        "meshes": meshes,
        "triangles": sum(mesh["triangles"] for mesh in meshes),
        "bounds": bounds,
    }
