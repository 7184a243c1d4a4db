"""One list of triangles from a tree's wood and its many leaves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flowtree import check
from flowtree.geometry.outward_directions import outward_directions
from flowtree.model.foliage import Foliage
from flowtree.model.mesh import Material, TreeMesh
from flowtree.model.tree import TreeModel


@dataclass(frozen=True)
class Scene:
    """The triangles of a tree, world frame: first the wood, then every leaf in turn.

    Attributes:
        positions: (3, n) float32 [m], a row for each coordinate.
        normals: (3, n) float32, unit.
        uvs: (n, 2) float32, as in `TreeMesh`.
        colors: (n, 3) float32, linear, multiplied with the texture.
        triangles: (m, 3) int32.
        wood_vertices: vertices before this one belong to the wood.
        wood_triangles: triangles before this one belong to the wood.
        bark: the wood's material.
        leaf: the leaves' material; None for a bare tree.
        alpha: (h, w) float32 in 0..1, the leaf texture's alpha.
        cutoff: where alpha is smaller no leaf is.
        tangents: (wood_vertices, 4) float32, as in `TreeMesh`; None where the bark shows no normal map.
    """

    positions: NDArray[np.float32]
    normals: NDArray[np.float32]
    uvs: NDArray[np.float32]
    colors: NDArray[np.float32]
    triangles: NDArray[np.int32]
    wood_vertices: int
    wood_triangles: int
    bark: Material
    leaf: Material | None
    alpha: NDArray[np.float32]
    cutoff: float
    tangents: NDArray[np.float32] | None = None


def assemble_scene(tree: TreeModel) -> Scene:
    """Places every leaf and joins it with the wood, so that rays need to know one kind of thing only.

    Args:
        tree: wood and leaves, world frame [m]. The wood is taken as solid; its texture's alpha is not used.

    Raises:
        InputError: a NaN, an index beyond the vertices, arrays that do not fit together.
    """
    _check_mesh(tree.wood, "wood")
    _check_material(tree.bark, "bark")
    wood, leaves = tree.wood, tree.foliage
    positions, normals = [wood.positions.T], [wood.normals.T]
    uvs, triangles = [wood.uvs], [wood.triangles]
    colors = [np.ones_like(wood.positions) if wood.colors is None else wood.colors]
    alpha, cutoff = np.ones((1, 1), np.float32), 0.0
    if leaves is not None:
        _check_mesh(leaves.leaf, "leaf")
        _check_material(leaves.material, "leaf material")
        _check_places(leaves)
        count, corners = len(leaves.position), len(leaves.leaf.positions)
        placed, turned = _place_leaves(leaves)
        positions.append(placed)
        normals.append(turned)
        uvs.append(np.tile(leaves.leaf.uvs, (count, 1)))
        tint = leaves.color if leaves.leaf.colors is None else leaves.color[:, None, :] * leaves.leaf.colors
        colors.append(np.repeat(tint, corners, axis=0) if tint.ndim == 2 else tint.reshape(-1, 3))
        shift = len(wood.positions) + corners * np.arange(count, dtype=np.int32)
        triangles.append((leaves.leaf.triangles[None] + shift[:, None, None]).reshape(-1, 3))
        material = leaves.material
        if material.alpha_cutoff is not None and material.base_color.shape[2] == 4:
            alpha = material.base_color[:, :, 3].astype(np.float32) / np.float32(255.0)
            cutoff = float(material.alpha_cutoff)
    return Scene(
        positions=np.concatenate(positions, axis=1, dtype=np.float32),
        normals=np.concatenate(normals, axis=1, dtype=np.float32),
        uvs=np.concatenate(uvs, dtype=np.float32),
        colors=np.concatenate(colors, dtype=np.float32),
        triangles=np.concatenate(triangles, dtype=np.int32),
        wood_vertices=len(wood.positions),
        wood_triangles=len(wood.triangles),
        bark=tree.bark,
        leaf=None if leaves is None else leaves.material,
        alpha=alpha,
        cutoff=cutoff,
        tangents=None if tree.bark.normal is None else wood.tangents,
    )


def corner_points(scene: Scene) -> NDArray[np.float32]:
    """The vertices (3, n) [m] that belong to a triangle, without the others that a file may hold."""
    used = np.zeros(scene.positions.shape[1], bool)
    used[scene.triangles] = True
    return scene.positions[:, used]


def _place_leaves(leaves: Foliage) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Positions and normals (3, count * corners) of all leaves' vertices.

    Each coordinate is summed by itself: the rounding of a matrix product depends on the number of cores.
    """
    x, y, z, w = leaves.rotation.T.astype(np.float32)
    turn = (
        (1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
        (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
        (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)),
    )
    mesh = leaves.leaf
    placed = np.empty((3, len(x), len(mesh.positions)), np.float32)
    turned = np.empty_like(placed)
    for axis, (a, b, c) in enumerate(turn):
        for out, of in ((placed, mesh.positions), (turned, mesh.normals)):
            out[axis] = np.multiply.outer(a, of[:, 0])
            out[axis] += np.multiply.outer(b, of[:, 1])
            out[axis] += np.multiply.outer(c, of[:, 2])
        placed[axis] *= leaves.scale[:, None]
        placed[axis] += leaves.position[:, axis, None]
    _round(turned, placed.mean(axis=2, dtype=np.float64).T, leaves.rounding)
    return placed.reshape(3, -1), turned.reshape(3, -1)


def _round(normals: NDArray[np.float32], centres: NDArray[np.float64], share: float) -> None:
    """Bends the normals (3, leaves, corners) in place toward the way out of the crown, as a file has them."""
    outward = outward_directions(centres).T[:, :, None]
    if not share or not outward.any():
        return
    own = (normals * outward).sum(axis=0).sum(axis=1)
    side = np.where(own < 0, np.float32(-share), np.float32(share))
    bent = np.float32(1 - share) * normals + side[:, None] * outward
    length = np.sqrt((bent * bent).sum(axis=0))
    np.divide(bent, length, out=normals, where=length > 1e-3)


def _check_mesh(mesh: TreeMesh, thing: str) -> None:
    count = len(mesh.positions)
    check.array(mesh.positions, f"{thing} positions", shape=(count, 3))
    check.array(mesh.normals, f"{thing} normals", shape=(count, 3))
    check.array(mesh.uvs, f"{thing} uvs", shape=(count, 2))
    if mesh.tangents is not None:
        check.array(mesh.tangents, f"{thing} tangents", shape=(count, 4))
    if mesh.colors is not None:
        check.array(mesh.colors, f"{thing} colors", shape=(count, 3), low=0.0)
    check.array(mesh.triangles, f"{thing} triangles", shape=(None, 3), low=0, high=max(count - 1, 0))


def _check_places(leaves: Foliage) -> None:
    count = len(leaves.position)
    check.array(leaves.position, "leaf position", shape=(count, 3))
    check.array(leaves.rotation, "leaf rotation", shape=(count, 4))
    check.array(leaves.scale, "leaf scale", shape=(count,), low=0.0)
    check.array(leaves.color, "leaf color", shape=(count, 3), low=0.0)


def _check_material(material: Material, thing: str) -> None:
    shape = material.base_color.shape
    holds = len(shape) == 3 and shape[2] in (3, 4) and shape[0] > 0 and shape[1] > 0
    check.require(
        holds, f"{thing} texture", "must have shape (any, any, 3 or 4)", shape, "pass an RGB or RGBA picture"
    )
