"""A tree as Wavefront OBJ, with its materials and textures beside it."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from flowtree import __version__
from flowtree.export.check_tree import check_tree
from flowtree.export.encode_texture import encode_texture
from flowtree.export.merge_leaves import merge_leaves
from flowtree.export.tint_texture import tint_texture
from flowtree.files import write_all_whole
from flowtree.model.mesh import Material, TreeMesh
from flowtree.model.tree import TreeModel

_ENDINGS = {"image/png": "png", "image/jpeg": "jpg"}


def write_obj(tree: TreeModel, path: Path) -> None:
    """Writes ``NAME.obj`` and beside it ``NAME.mtl`` and a picture ``NAME_…`` for every texture.

    Metres, y up; objects and materials are named as the nodes of the GLB. OBJ has no colour of single leaves
    that programs agree on, so the mean of their colours is multiplied into the picture. White space in names
    becomes ``_``, because OBJ separates words with it.

    Raises:
        InputError: the tree is broken (see `check_tree`).
        OutputError: one of the files could not be written; what stood there is untouched, of all of them.
    """
    check_tree(tree)
    stem, name = re.sub(r"\s", "_", path.stem), re.sub(r"\s", "_", tree.name) or "Tree"
    parts = [("wood", tree.wood, tree.bark)] if len(tree.wood.triangles) else []
    if tree.foliage is not None and len(tree.foliage.position):
        parts.append(("leaves", merge_leaves(tree.foliage), tree.foliage.material))
    text = [f"# flowtree {__version__}, metres, y up\nmtllib {stem}.mtl\n"]
    materials = [f"# flowtree {__version__}\n"]
    contents: dict[Path, bytes] = {}
    first = 1
    for part, mesh, material in parts:
        text += [f"o {name}_{part}\nusemtl {name}_{part}\n", *_geometry(mesh, first)]
        first += len(mesh.positions)
        materials.append(
            _material(f"{name}_{part}", _tint(mesh, material), path.with_name(f"{stem}_{part}"), contents)
        )
    contents[path.with_name(f"{stem}.mtl")] = "".join(materials).encode("utf-8", "replace")
    contents[path] = "".join(text).encode("utf-8", "replace")
    write_all_whole(contents)


def _geometry(mesh: TreeMesh, first: int) -> list[str]:
    """The lines of a mesh whose vertices are counted from ``first``."""
    # OBJ's texture coordinates start at the picture's lower edge.
    uvs = mesh.uvs * np.array([1, -1], np.float32) + np.array([0, 1], np.float32)
    corners = np.repeat(mesh.triangles.astype(np.int64) + first, 3, axis=1)
    return [
        _lines("v %.7g %.7g %.7g\n", mesh.positions),
        _lines("vt %.6g %.6g\n", uvs),
        _lines("vn %.4g %.4g %.4g\n", mesh.normals),
        _lines("f %d/%d/%d %d/%d/%d %d/%d/%d\n", corners),
    ]


def _lines(pattern: str, rows: NDArray[np.generic]) -> str:
    # One formatting of all rows at once: ten times as fast as a loop over them.
    return (pattern * len(rows)) % tuple(rows.ravel().tolist())


def _tint(mesh: TreeMesh, material: Material) -> Material:
    """The material in the mean colour of the mesh."""
    if mesh.colors is None:
        return material
    mean = mesh.colors.mean(axis=0, dtype=np.float64)
    return replace(material, base_color=tint_texture(material.base_color, mean))


def _material(name: str, material: Material, beside: Path, contents: dict[Path, bytes]) -> str:
    """The material's lines; its pictures are added to the contents."""
    masked = material.alpha_cutoff is not None
    pixels = material.base_color if masked else material.base_color[:, :, :3]
    color = _picture(pixels, beside, contents, lossy=not masked)
    lines = [
        f"newmtl {name}",
        "Ka 0 0 0",
        "Kd 1 1 1",
        "Ks 0 0 0",
        "Pm 0",  # metallic and roughness: the PBR extension, known to Blender, three.js and Assimp
        f"Pr {material.roughness:g}",
        f"map_Kd {color}",
    ]
    if masked and pixels.shape[2] == 4:
        lines.append(f"map_d {color}")
    if material.normal is not None:
        normal = _picture(material.normal, beside.with_name(f"{beside.name}_normal"), contents, lossy=True)
        lines.append(f"norm {normal}")
    return "\n".join(lines) + "\n\n"


def _picture(pixels: NDArray[np.uint8], beside: Path, contents: dict[Path, bytes], *, lossy: bool) -> str:
    data, media = encode_texture(pixels, lossy=lossy)
    path = beside.with_name(f"{beside.name}.{_ENDINGS[media]}")
    contents[path] = data
    return path.name
