"""A tree back from the GLB file that we wrote, ready to be rendered."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flowtree import check
from flowtree.export.check_tree import check_tree
from flowtree.export.decode_texture import decode_texture
from flowtree.export.parse_glb import GlbFile, parse_glb, refuse_malformed
from flowtree.model.foliage import Foliage
from flowtree.model.mesh import Material, TreeMesh
from flowtree.model.skeleton import Skeleton
from flowtree.model.tree import TreeModel


def read_glb(path: Path) -> TreeModel:
    """Reads a tree that `write_glb` wrote.

    A file holds less than the model: all leaves come back as one compound leaf at the origin, 1 m long, with
    the leaves' colours in its vertices (unless they are instanced), of several levels the finest, and the
    skeleton as its root alone. Positions and triangles are those that were written, bit for bit, unless the
    file is quantised.

    Raises:
        InputError: it cannot be read, is damaged, or is no tree of ours.
    """
    file = parse_glb(path)
    with refuse_malformed(file.name):
        tree = _read_tree(file)
    check_tree(tree)
    return tree


def _read_tree(file: GlbFile) -> TreeModel:
    placed = {
        str(node.get("name", "")): (node, matrix) for node, matrix in file.placed_nodes() if "mesh" in node
    }
    roots = file.document["scenes"][file.document.get("scene", 0)]["nodes"]
    root = file.entries("nodes")[roots[0]]
    name = str(root.get("name", ""))
    wood, leaves = (
        placed.get(f"{name}_{part}") or placed.get(f"{name}_LOD0_{part}") for part in ("wood", "leaves")
    )
    check.require(
        (wood is not None or leaves is not None) and "height" in root.get("extras", {}),
        file.name,
        "must be a tree that flowtree wrote",
        f"nodes named {', '.join(sorted(placed)[:4]) or 'nothing'}",
        "reconstruct it, or open it in another program",
    )
    surface, bark = _no_wood() if wood is None else _read_part(file, *wood)
    return TreeModel(
        name=name,
        height=float(root["extras"]["height"]),
        skeleton=_root_alone(),
        wood=surface,
        bark=bark,
        foliage=None if leaves is None else _read_leaves(file, *leaves),
    )


def _read_part(file: GlbFile, node: dict[str, Any], matrix: NDArray[np.float64]) -> tuple[TreeMesh, Material]:
    mesh = file.entry("meshes", node["mesh"])
    (primitive,) = mesh["primitives"]
    attributes = primitive["attributes"]
    entry = file.entries("materials")[primitive["material"]]
    surface = entry["pbrMetallicRoughness"]
    factor = np.array(surface["baseColorFactor"][:3], np.float64)
    colors: NDArray[np.float32] | None = None
    positions = file.accessor(attributes["POSITION"])
    if "COLOR_0" in attributes and mesh.get("extras", {}).get("COLOR_0") != "wind":
        colors = (file.accessor(attributes["COLOR_0"])[:, :3] * factor).astype(np.float32)
    elif (factor != 1.0).any():
        colors = np.broadcast_to(factor.astype(np.float32), positions.shape).copy()
    if not np.array_equal(matrix, np.eye(4)):  # quantised, or moved by another program
        positions = (positions @ matrix[:3, :3].T + matrix[:3, 3]).astype(np.float32)
    normal = entry.get("normalTexture")
    through = entry.get("extensions", {}).get("KHR_materials_diffuse_transmission", {})
    material = Material(
        name=str(entry["name"]),
        base_color=_read_picture(file, surface["baseColorTexture"]["index"]),
        normal=None if normal is None else _read_picture(file, normal["index"])[:, :, :3],
        roughness=float(surface["roughnessFactor"]),
        double_sided=bool(entry.get("doubleSided", False)),
        alpha_cutoff=float(entry["alphaCutoff"]) if entry.get("alphaMode") == "MASK" else None,
        translucency=float(through.get("diffuseTransmissionFactor", 0.0)),
    )
    triangles = file.accessor(primitive["indices"]).astype(np.int64).reshape(-1, 3)
    geometry = TreeMesh(
        positions=positions,
        normals=file.accessor(attributes["NORMAL"]),
        uvs=file.accessor(attributes["TEXCOORD_0"]),
        triangles=triangles.astype(np.int32),
        colors=colors,
        tangents=file.accessor(attributes["TANGENT"]) if "TANGENT" in attributes else None,
    )
    return geometry, material


def _read_leaves(file: GlbFile, node: dict[str, Any], matrix: NDArray[np.float64]) -> Foliage:
    geometry, material = _read_part(file, node, matrix)
    instancing = node.get("extensions", {}).get("EXT_mesh_gpu_instancing")
    if instancing is None:
        return _one_leaf(geometry, material)
    places = {name: file.accessor(index) for name, index in instancing["attributes"].items()}
    count = len(places["TRANSLATION"])
    return Foliage(
        leaf=geometry,
        material=material,
        position=places["TRANSLATION"],
        rotation=places["ROTATION"],
        scale=places["SCALE"][:, 0],
        color=places["_COLOR_0"],
        node=np.zeros(count, np.int32),
    )


def _read_picture(file: GlbFile, texture: int) -> NDArray[np.uint8]:
    image = file.entries("images")[file.entries("textures")[texture]["source"]]
    return decode_texture(
        file.view(image["bufferView"]), f"{file.name}: texture {image.get('name', texture)}"
    )


def _no_wood() -> tuple[TreeMesh, Material]:
    none = np.zeros((0, 3), np.float32)
    mesh = TreeMesh(none, none, np.zeros((0, 2), np.float32), np.zeros((0, 3), np.int32))
    return mesh, Material("bark", np.full((1, 1, 3), 255, np.uint8))


def _one_leaf(geometry: TreeMesh, material: Material) -> Foliage:
    return Foliage(
        leaf=geometry,
        material=material,
        position=np.zeros((1, 3), np.float32),
        rotation=np.array([[0, 0, 0, 1]], np.float32),
        scale=np.ones(1, np.float32),
        color=np.ones((1, 3), np.float32),
        node=np.zeros(1, np.int32),
        rounding=0.0,  # the normals in the file are round already
    )


def _root_alone() -> Skeleton:
    return Skeleton(
        parent=np.array([-1], np.int32),
        points=np.zeros((1, 3), np.float32),
        radius=np.zeros(1, np.float32),
        particles=np.zeros(1, np.int32),
        level=np.zeros(1, np.int32),
        twig=np.zeros(1, np.bool_),
    )
