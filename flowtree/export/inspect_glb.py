"""What a GLB file holds."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flowtree.export.decode_texture import texture_size
from flowtree.export.instance_places import instance_places
from flowtree.export.parse_glb import GlbFile, parse_glb, refuse_malformed
from flowtree.geometry.closed_surfaces import is_closed, weld, without_sheets

_TRIANGLES = 4
_AT_ONCE = 4096  # instances
# Lengths between which something is a tree [m].
_LEAST_HEIGHT, _MOST_HEIGHT = 0.05, 130.0


def inspect_glb(path: Path) -> dict[str, Any]:
    """Reads a GLB of any origin and lists what is in it.

    Returns: ``{"kind", "bytes", "generator", "nodes": [name], "meshes": [{"name", "triangles", "vertices",
        "instances", "materials", "attributes"}], "triangles", "levels": [{"name", "triangles", "vertices"}],
        "bodies": [{"name", "triangles"}], "materials": [{"name", "alpha_mode", "double_sided"}], "textures":
        [{"name", "width", "height", "bytes"}], "skins": [{"joints"}], "animations": [{"name", "seconds",
        "channels"}], "extensions": {"used", "required"}, "bounds": {"min", "max"} [m] or None, "watertight",
        "warnings": [text]}``; meshes, triangles and bounds are those of the scene to show, and an instanced
        mesh counts as often as it stands there; levels, where there are several, are its and the other
        scenes'; ``watertight`` is the wood's but for sheets seen from both sides,
        None where no mesh is named so.

    Raises:
        InputError: it cannot be read, is no GLB, is damaged, or its meshes are compressed.
    """
    file = parse_glb(path)
    with refuse_malformed(file.name):
        return _inspect(file)


def _inspect(file: GlbFile) -> dict[str, Any]:
    shown = list(file.placed_nodes())
    seen = [(node, matrix) for node, matrix in shown if not _is_body(node)]
    meshes, corners, watertight = _measure(file, seen)
    bounds = None
    if corners:
        low, high = np.min(corners, axis=0), np.max(corners, axis=0)
        if not (np.isfinite(low).all() and np.isfinite(high).all()):
            raise ValueError("nodes that place their meshes at infinity")
        bounds = {"min": np.round(low, 6).tolist(), "max": np.round(high, 6).tolist()}
    bodies, _, _ = _measure(file, [(node, matrix) for node, matrix in shown if _is_body(node)])
    found: dict[str, Any] = {
        "kind": "glb",
        "bytes": file.size,
        "generator": file.document["asset"].get("generator"),
        "nodes": [node.get("name") for node in file.entries("nodes")],
        "meshes": meshes,
        "triangles": sum(mesh["triangles"] for mesh in meshes),
        "levels": _levels(file, meshes),
        "bodies": [{"name": body["name"], "triangles": body["triangles"]} for body in bodies],
        "materials": [_material(entry) for entry in file.entries("materials")],
        "textures": [_texture(file, k, image) for k, image in enumerate(file.entries("images"))],
        "skins": [{"joints": len(skin["joints"])} for skin in file.entries("skins")],
        "animations": [_animation(file, entry) for entry in file.entries("animations")],
        "extensions": {
            "used": list(file.document.get("extensionsUsed", [])),
            "required": list(file.document.get("extensionsRequired", [])),
        },
        "bounds": bounds,
        "watertight": watertight,
    }
    return found | {"warnings": _warnings(found)}


def _is_body(node: dict[str, Any]) -> bool:
    return node.get("extras", {}).get("collision") is True


def _measure(
    file: GlbFile, nodes: list[tuple[dict[str, Any], NDArray[np.float64]]]
) -> tuple[list[dict[str, Any]], list[NDArray[np.float64]], bool | None]:
    """The meshes of the nodes, corners of boxes around them, and whether the wood among them is closed."""
    meshes: list[dict[str, Any]] = []
    corners: list[NDArray[np.float64]] = []
    watertight: bool | None = None
    for node, matrix in nodes:
        if "mesh" not in node:
            continue
        mesh = file.entry("meshes", node["mesh"])
        name = node.get("name") or mesh.get("name") or f"mesh {node['mesh']}"
        pieces = [piece for piece in mesh["primitives"] if piece.get("mode", _TRIANGLES) == _TRIANGLES]
        surfaces = [_surface(file, piece) for piece in pieces]
        names = [_material_name(file, piece) for piece in pieces]
        places = instance_places(file, node)
        meshes.append(
            {
                "name": name,
                "triangles": sum(len(triangles) for _, triangles in surfaces) * len(places),
                "vertices": sum(len(positions) for positions, _ in surfaces),
                "instances": len(places),
                "materials": [name for name in names if name is not None],
                "attributes": sorted({key for piece in pieces for key in piece["attributes"]}),
            }
        )
        for positions, _ in surfaces:
            corners += _box(positions, matrix @ places)
        if name.endswith("_wood"):
            shut = all(_is_shut(file, *each) for each in zip(pieces, surfaces, strict=True))
            watertight = watertight is not False and shut
    return meshes, corners, watertight


def _is_shut(
    file: GlbFile, piece: dict[str, Any], surface: tuple[NDArray[np.float64], NDArray[np.int64]]
) -> bool:
    """Whether a surface is closed; where both sides are seen, twigs may be sheets."""
    triangles = weld(*surface)
    if "material" in piece and file.entry("materials", piece["material"]).get("doubleSided"):
        triangles = without_sheets(triangles)
    return is_closed(triangles)


def _box(positions: NDArray[np.float64], matrices: NDArray[np.float64]) -> list[NDArray[np.float64]]:
    """Least and greatest coordinates of all positions (n, 3) under all matrices (k, 4, 4)."""
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for first in range(0, len(matrices), _AT_ONCE):
        some = matrices[first : first + _AT_ONCE]
        placed = positions @ some[:, :3, :3].transpose(0, 2, 1) + some[:, None, :3, 3]
        low = np.minimum(low, placed.min(axis=(0, 1)))
        high = np.maximum(high, placed.max(axis=(0, 1)))
    return [low, high]


def _levels(file: GlbFile, shown: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """The levels of detail: what is shown, and what the scenes behind it hold."""
    scenes = file.entries("scenes")
    if len(scenes) < 2:
        return []
    levels = []
    for k, scene in enumerate(scenes):
        if k == file.document.get("scene", 0):
            name, meshes = "shown", shown
        else:
            nodes = [(node, matrix) for node, matrix in file.placed_nodes(k) if not _is_body(node)]
            name = str(scene.get("name", f"scene {k}")).removesuffix("_scene")
            meshes, _, _ = _measure(file, nodes)
        counts = {key: sum(mesh[key] for mesh in meshes) for key in ("triangles", "vertices")}
        levels.append({"name": name, **counts})
    return levels


def _animation(file: GlbFile, entry: dict[str, Any]) -> dict[str, Any]:
    ends = [float(file.accessor(sampler["input"]).max()) for sampler in entry["samplers"]]
    return {
        "name": entry.get("name"),
        "seconds": max(ends, default=0.0),
        "channels": len(entry["channels"]),
    }


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
    if found["extensions"]["required"]:
        warnings.append(f"needs a program that knows {', '.join(map(str, found['extensions']['required']))}")
    outside = [texture["name"] for texture in found["textures"] if texture["bytes"] is None]
    warnings += [f"{name}: a texture outside the file" for name in outside]
    return warnings
