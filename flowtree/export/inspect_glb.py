"""What a GLB file holds."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flowtree.export.decode_texture import texture_size
from flowtree.export.parse_glb import GlbFile, parse_glb, refuse_malformed
from flowtree.geometry.closed_surfaces import is_closed, weld

_TRIANGLES = 4
# Lengths between which something is a tree [m].
_LEAST_HEIGHT, _MOST_HEIGHT = 0.05, 130.0


def inspect_glb(path: Path) -> dict[str, Any]:
    """Reads a GLB of any origin and lists what is in it.

    Returns: ``{"kind", "bytes", "generator", "nodes": [name], "meshes": [{"name", "triangles", "vertices",
        "materials"}], "triangles", "materials": [{"name", "alpha_mode", "double_sided"}], "textures":
        [{"name", "width", "height", "bytes"}], "bounds": {"min", "max"} [m] or None, "watertight",
        "warnings": [text]}``; ``watertight`` is the wood's, None where no mesh is named so.

    Raises:
        InputError: it cannot be read, is no GLB, is damaged, or its meshes are compressed.
    """
    file = parse_glb(path)
    with refuse_malformed(file.name):
        return _inspect(file)


def _inspect(file: GlbFile) -> dict[str, Any]:
    meshes: list[dict[str, Any]] = []
    corners: list[NDArray[np.float64]] = []
    watertight: bool | None = None
    for name, mesh, matrix in file.placed_meshes():
        pieces = [piece for piece in mesh["primitives"] if piece.get("mode", _TRIANGLES) == _TRIANGLES]
        surfaces = [_surface(file, piece) for piece in pieces]
        names = [_material_name(file, piece) for piece in pieces]
        meshes.append(
            {
                "name": name,
                "triangles": sum(len(triangles) for _, triangles in surfaces),
                "vertices": sum(len(positions) for positions, _ in surfaces),
                "materials": [name for name in names if name is not None],
            }
        )
        for positions, _ in surfaces:
            placed = positions @ matrix[:3, :3].T + matrix[:3, 3]
            corners += [placed.min(axis=0), placed.max(axis=0)]
        if name.endswith("_wood"):
            watertight = watertight is not False and all(is_closed(weld(*surface)) for surface in surfaces)
    bounds = None
    if corners:
        low, high = np.min(corners, axis=0), np.max(corners, axis=0)
        if not (np.isfinite(low).all() and np.isfinite(high).all()):
            raise ValueError("nodes that place their meshes at infinity")
        bounds = {"min": np.round(low, 6).tolist(), "max": np.round(high, 6).tolist()}
    found: dict[str, Any] = {
        "kind": "glb",
        "bytes": file.size,
        "generator": file.document["asset"].get("generator"),
        "nodes": [node.get("name") for node in file.entries("nodes")],
        "meshes": meshes,
        "triangles": sum(mesh["triangles"] for mesh in meshes),
        "materials": [_material(entry) for entry in file.entries("materials")],
        "textures": [_texture(file, k, image) for k, image in enumerate(file.entries("images"))],
        "bounds": bounds,
        "watertight": watertight,
    }
    return found | {"warnings": _warnings(found)}


def _surface(file: GlbFile, piece: dict[str, Any]) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    positions = file.accessor(piece["attributes"]["POSITION"]).astype(np.float64).reshape(-1, 3)
    count = len(positions)
    flat = file.accessor(piece["indices"]).astype(np.int64) if "indices" in piece else np.arange(count)
    if not np.isfinite(positions).all() or flat.ndim != 1 or flat.min() < 0 or flat.max() >= count:
        raise ValueError("a mesh with NaN or with an index beyond its vertices")
    return positions, flat[: len(flat) // 3 * 3].reshape(-1, 3)


def _material_name(file: GlbFile, piece: dict[str, Any]) -> str | None:
    if "material" not in piece:
        return None
    return str(file.entries("materials")[piece["material"]].get("name", f"material {piece['material']}"))


def _material(entry: dict[str, Any]) -> dict[str, Any]:
    return {
        "name": entry.get("name"),
        "alpha_mode": entry.get("alphaMode", "OPAQUE"),
        "double_sided": bool(entry.get("doubleSided", False)),
    }


def _texture(file: GlbFile, index: int, image: dict[str, Any]) -> dict[str, Any]:
    name = image.get("name", f"image {index}")
    if "bufferView" not in image:  # beside the file, or inside its text
        return {"name": name, "width": None, "height": None, "bytes": None}
    data = file.view(image["bufferView"])
    width, height = texture_size(data, f"{file.name}: texture {name}")
    return {"name": name, "width": width, "height": height, "bytes": len(data)}


def _warnings(found: dict[str, Any]) -> list[str]:
    """What is allowed, but hardly meant."""
    warnings = []
    if found["bounds"] is None:
        return ["no mesh in the scene"]
    low, high = np.array(found["bounds"]["min"]), np.array(found["bounds"]["max"])
    height = high[1] - low[1]
    if not _LEAST_HEIGHT <= height <= _MOST_HEIGHT:
        warnings.append(f"{height:.4g} m high: are these metres, with y up?")
    if low[1] < -0.05 * height or low[1] > 0.05 * height:
        warnings.append(f"the lowest point lies at y = {low[1]:.4g} m, not at the ground")
    if np.any(low[[0, 2]] > 0) or np.any(high[[0, 2]] < 0):
        warnings.append("the y axis does not pass through the tree: the foot is not at the origin")
    if found["watertight"] is False:
        warnings.append("the wood is not watertight")
    warnings += [f"{mesh['name']}: no material" for mesh in found["meshes"] if not mesh["materials"]]
    warnings += [f"{mesh['name']}: no triangle" for mesh in found["meshes"] if not mesh["triangles"]]
    outside = [texture["name"] for texture in found["textures"] if texture["bytes"] is None]
    warnings += [f"{name}: a texture outside the file" for name in outside]
    return warnings
