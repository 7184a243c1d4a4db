"""A tree as PLY, for the programs of laser scanning and geometry processing."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from flowtree import __version__
from flowtree.export.check_tree import check_tree
from flowtree.export.mean_color import mean_color
from flowtree.export.merge_leaves import merge_leaves
from flowtree.files import write_whole
from flowtree.geometry.srgb import encode_srgb_bytes
from flowtree.model.mesh import Material, TreeMesh
from flowtree.model.tree import TreeModel

_VERTEX = [("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("nx", "<f4"), ("ny", "<f4"), ("nz", "<f4")]
_COLOR = [("red", "u1"), ("green", "u1"), ("blue", "u1")]
_FACE = [("count", "u1"), ("corners", "<i4", 3), ("part", "u1")]


def write_ply(tree: TreeModel, path: Path) -> None:
    """Writes wood and leaves as one binary PLY: metres, y up; a face's ``part`` is 0 in wood, 1 in leaves.

    PLY has no textures: a vertex has the mean colour of its texture times its own, in sRGB, and a leaf its
    whole blade, without the parts that the texture cuts away.

    Raises:
        InputError: the tree is broken (see `check_tree`).
        OutputError: the file could not be written; what stood there is untouched.
    """
    check_tree(tree)
    parts = [(tree.wood, tree.bark)]
    if tree.foliage is not None:
        parts.append((merge_leaves(tree.foliage), tree.foliage.material))
    vertices = np.concatenate([_vertices(mesh, material) for mesh, material in parts])
    faces = np.empty(sum(len(mesh.triangles) for mesh, _ in parts), _FACE)
    faces["count"] = 3
    vertex = face = 0
    for part, (mesh, _) in enumerate(parts):
        rows = slice(face, face + len(mesh.triangles))
        faces["corners"][rows] = mesh.triangles + vertex
        faces["part"][rows] = part
        vertex, face = vertex + len(mesh.positions), face + len(mesh.triangles)
    head = [
        "ply",
        "format binary_little_endian 1.0",
        f"comment flowtree {__version__}, metres, y up",
        f"element vertex {len(vertices)}",
        *(f"property float {name}" for name, _ in _VERTEX),
        *(f"property uchar {name}" for name, _ in _COLOR),
        f"element face {len(faces)}",
        "property list uchar int vertex_indices",
        "property uchar part",
        "end_header",
    ]
    write_whole(path, ("\n".join(head) + "\n").encode() + vertices.tobytes() + faces.tobytes())


def _vertices(mesh: TreeMesh, material: Material) -> NDArray[np.void]:
    rows = np.empty(len(mesh.positions), _VERTEX + _COLOR)
    for column, axis in enumerate("xyz"):
        rows[axis] = mesh.positions[:, column]
        rows[f"n{axis}"] = mesh.normals[:, column]
    own = np.ones((len(rows), 3), np.float32) if mesh.colors is None else mesh.colors
    colors = encode_srgb_bytes(own * mean_color(material))
    for column, (name, _) in enumerate(_COLOR):
        rows[name] = colors[:, column]
    return rows
