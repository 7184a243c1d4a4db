"""The border of the writers: what a tree must be before it becomes a file."""

from __future__ import annotations

import math

import numpy as np

from flowtree import check
from flowtree.export.check_skeleton import MOST_METRES
from flowtree.model.foliage import Foliage
from flowtree.model.mesh import Material, TreeMesh
from flowtree.model.tree import TreeModel


def check_tree(tree: TreeModel) -> None:
    """Refuses a tree that would make a broken file.

    Raises:
        InputError: an array has the wrong shape or holds NaN, a triangle names a vertex that is not there, a
            texture is not a picture, or there is nothing to write at all.
    """
    measured = math.isfinite(tree.height)
    check.require(measured, "tree's height", "must be a number of metres", tree.height, "measure it")
    check_mesh(tree.wood, "wood")
    check_material(tree.bark, "bark")
    leaves = 0
    if tree.foliage is not None:
        _check_foliage(tree.foliage)
        leaves = len(tree.foliage.position) * len(tree.foliage.leaf.triangles)
    triangles = len(tree.wood.triangles) + leaves
    check.require(triangles > 0, "tree", "needs a triangle", "none", "mesh the skeleton first")


def check_mesh(mesh: TreeMesh, thing: str) -> None:
    """Refuses a mesh with an array of the wrong shape, NaN, or a triangle of vertices that are not there.

    Raises:
        InputError: it is so; ``thing`` names the mesh.
    """
    count = len(mesh.positions)
    check.array(mesh.positions, f"{thing}'s positions", shape=(None, 3), low=-MOST_METRES, high=MOST_METRES)
    check.array(mesh.normals, f"{thing}'s normals", shape=(count, 3))
    check.array(
        mesh.uvs, f"{thing}'s texture coordinates", shape=(count, 2), low=-MOST_METRES, high=MOST_METRES
    )
    if mesh.colors is not None:
        check.array(mesh.colors, f"{thing}'s colours", shape=(count, 3), low=0.0, high=1.0)
    if mesh.tangents is not None:
        check.array(mesh.tangents, f"{thing}'s tangents", shape=(count, 4))
    check.array(
        mesh.triangles, f"{thing}'s triangles", shape=(None, 3), dtype=np.int32, low=0.0, high=count - 1.0
    )


def _check_foliage(foliage: Foliage) -> None:
    check_mesh(foliage.leaf, "leaf")
    check_material(foliage.material, "leaf material")
    count = len(foliage.position)
    check.array(foliage.position, "leaf positions", shape=(None, 3), low=-MOST_METRES, high=MOST_METRES)
    turns = check.array(foliage.rotation, "leaf rotations", shape=(count, 4), dtype=np.float64)
    if count:
        lengths = np.linalg.norm(turns, axis=1)
        worst = float(lengths[np.abs(lengths - 1.0).argmax()])
        unit = abs(worst - 1.0) < 1e-3
        check.require(
            unit, "leaf rotations", "must be unit quaternions", f"length {worst:g}", "normalise them"
        )
    check.array(foliage.scale, "leaf lengths", shape=(count,), low=0.0, high=MOST_METRES)
    check.array(foliage.color, "leaf colours", shape=(count, 3), low=0.0, high=1.0)


def check_material(material: Material, thing: str, *, deep: bool = False) -> None:
    """Refuses a material whose textures are no pictures or whose numbers lie outside their range.

    Args:
        material: to be written.
        thing: what it belongs to.
        deep: whether its normal map has depths in a fourth channel.

    Raises:
        InputError: it is so; ``thing`` names the material.
    """
    for picture, name in ((material.base_color, "texture"), (material.normal, "normal map")):
        if picture is None:
            continue
        channels = (3, 4) if name == "texture" else (4,) if deep else (3,)
        fits = (
            picture.ndim == 3
            and picture.shape[2] in channels
            and picture.size > 0
            and picture.dtype == np.uint8
        )
        rule = f"must be (h, w, {' or '.join(map(str, channels))}) uint8"
        got = f"{picture.shape} {picture.dtype}"
        check.require(fits, f"{thing}'s {name}", rule, got, "pass a picture")
    roughness = 0.0 <= material.roughness <= 1.0
    check.require(
        roughness, f"{thing}'s roughness", "must lie in 0..1", material.roughness, "choose such a number"
    )
    through = material.translucency
    check.require(
        0.0 <= through <= 1.0, f"{thing}'s translucency", "must lie in 0..1", through, "choose such a number"
    )
    cutoff = material.alpha_cutoff
    valid = cutoff is None or 0.0 <= cutoff <= 1.0
    check.require(valid, f"{thing}'s alpha cutoff", "must lie in 0..1", cutoff, "choose such a number")
