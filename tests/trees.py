"""Trees made by hand, small and exact: what tests of writers and renderers start from."""

from __future__ import annotations

import dataclasses

import numpy as np
from numpy.typing import NDArray

from flowtree.model.foliage import Foliage
from flowtree.model.mesh import Material, TreeMesh
from flowtree.model.skeleton import Skeleton
from flowtree.model.tree import TreeModel


def hand_made_skeleton(branch_count: int = 5, seed: int = 0) -> Skeleton:
    """A trunk of four nodes up the y axis, and branches of two nodes that leave it."""
    rng = np.random.default_rng(seed)
    parent, points, radius, level = (
        [-1, 0, 1, 2],
        [[0, y, 0] for y in (0, 1, 2, 3.5)],
        [0.2, 0.15, 0.1, 0.06],
        [0] * 4,
    )
    for k in range(branch_count):
        turn, fork = np.radians(137.5 * k), 1 + k % 2
        out = np.array([np.cos(turn), 0.6 + 0.3 * rng.random(), np.sin(turn)])
        middle = np.array(points[fork]) + 0.5 * out
        parent += [fork, len(parent)]
        points += [middle.tolist(), (middle + 0.6 * out + [0, 0.2, 0]).tolist()]
        radius += [0.05, 0.01]
        level += [1, 1]
    count = len(parent)
    passing = np.ones(count, np.int32)
    for child in range(count - 1, 0, -1):
        if (np.array(parent) == child).any():
            passing[child] -= 1
        passing[parent[child]] += passing[child]
    passing[0] -= 1
    twig = np.zeros(count, bool)
    twig[count - 1] = branch_count > 0
    return Skeleton(
        parent=np.array(parent, np.int32),
        points=np.array(points, np.float32),
        radius=np.array(radius, np.float32),
        particles=passing,
        level=np.array(level, np.int32),
        twig=twig,
    )


def tapered_prism(
    start: NDArray[np.float32], end: NDArray[np.float32], r0: float, r1: float, sides: int = 7
) -> TreeMesh:
    """A closed tapered prism with a seam of texture coordinates and two flat caps."""
    axis = np.asarray(end, float) - start
    length = np.linalg.norm(axis)
    axis = axis / length
    across = np.cross(axis, [1.0, 0, 0] if abs(axis[0]) < 0.8 else [0, 0, 1.0])
    across /= np.linalg.norm(across)
    turn = np.linspace(0, 2 * np.pi, sides + 1)
    turn[-1] = 0.0  # the seam's two columns of vertices share their places to the bit
    radial = np.cos(turn)[:, None] * across + np.sin(turn)[:, None] * np.cross(axis, across)
    low, high = start + r0 * radial, np.asarray(end) + r1 * radial
    u = np.linspace(0, 1, sides + 1)
    k = np.arange(sides)
    n = sides + 1
    side = np.concatenate([np.stack([k, k + 1, n + k + 1], 1), np.stack([k, n + k + 1, n + k], 1)])
    fan = np.arange(1, sides - 1)
    bottom = 2 * n + np.stack([np.zeros_like(fan), fan + 1, fan], 1)
    top = 2 * n + sides + np.stack([np.zeros_like(fan), fan, fan + 1], 1)
    uvs = np.stack([np.concatenate([u, u]), np.repeat([0.0, length], n)], 1)
    return TreeMesh(
        positions=np.concatenate([low, high, low[:-1], high[:-1]]).astype(np.float32),
        normals=np.concatenate(
            [radial, radial, np.tile(-axis, (sides, 1)), np.tile(axis, (sides, 1))]
        ).astype(np.float32),
        uvs=np.concatenate([uvs, np.full((2 * sides, 2), 0.5)]).astype(np.float32),
        triangles=np.concatenate([side, bottom, top]).astype(np.int32),
    )


def join_meshes(meshes: list[TreeMesh]) -> TreeMesh:
    """Several meshes without colours as one."""
    first = np.cumsum([0] + [len(mesh.positions) for mesh in meshes[:-1]])
    return TreeMesh(
        positions=np.concatenate([mesh.positions for mesh in meshes]),
        normals=np.concatenate([mesh.normals for mesh in meshes]),
        uvs=np.concatenate([mesh.uvs for mesh in meshes]),
        triangles=np.concatenate(
            [mesh.triangles + np.int32(k) for mesh, k in zip(meshes, first, strict=True)]
        ).astype(np.int32),
    )


def leaf_quad() -> TreeMesh:
    """A leaf of two triangles, 1 m long and 0.6 m wide, its upper side to +z."""
    return TreeMesh(
        positions=np.array([[-0.3, 0, 0], [0.3, 0, 0], [0.3, 1, 0], [-0.3, 1, 0]], np.float32),
        normals=np.tile(np.array([0, 0, 1], np.float32), (4, 1)),
        uvs=np.array([[0, 1], [1, 1], [1, 0], [0, 0]], np.float32),
        triangles=np.array([[0, 1, 2], [0, 2, 3]], np.int32),
    )


def bark_material(size: int = 64, seed: int = 0) -> Material:
    """Brown noise with a flat normal map."""
    rng = np.random.default_rng(seed)
    grain = rng.integers(0, 60, (size, size, 1))
    normal = np.broadcast_to(np.array([128, 128, 255], np.uint8), (size, size, 3))
    return Material("bark", (np.array([90, 70, 50]) + grain).astype(np.uint8), normal.copy())


def leaf_material(size: int = 32) -> Material:
    """A green ellipse, cut out by its alpha."""
    y, x = np.mgrid[:size, :size] / (size - 1) * 2 - 1
    picture = np.empty((size, size, 4), np.uint8)
    picture[:] = (70, 120, 40, 255)
    picture[..., 3] = np.where(x**2 * 1.5 + y**2 < 1, 255, 0)
    return Material("leaf", picture, roughness=0.7, double_sided=True, alpha_cutoff=0.5)


def scatter_leaves(skeleton: Skeleton, count: int, seed: int = 0, shape: TreeMesh | None = None) -> Foliage:
    """Leaves at random places along the outer segments, turned at random, green to yellow."""
    rng = np.random.default_rng(seed)
    node = rng.integers(len(skeleton.parent) // 2, len(skeleton.parent), count).astype(np.int32)
    share = rng.random((count, 1))
    start, end = skeleton.points[skeleton.parent[node]], skeleton.points[node]
    turn = rng.normal(size=(count, 4))
    return Foliage(
        leaf=leaf_quad() if shape is None else shape,
        material=leaf_material(),
        position=(start + share * (end - start)).astype(np.float32),
        rotation=(turn / np.linalg.norm(turn, axis=1, keepdims=True)).astype(np.float32),
        scale=rng.uniform(0.08, 0.2, count).astype(np.float32),
        color=rng.uniform([0.1, 0.5, 0.02], [0.6, 0.9, 0.2], (count, 3)).astype(np.float32),
        node=node,
    )


def hand_made_tree(
    leaf_count: int = 60, *, branch_count: int = 5, name: str = "Oak", seed: int = 0
) -> TreeModel:
    """A small leafy tree; closed wood, one prism a segment."""
    skeleton = hand_made_skeleton(branch_count, seed)
    prisms = [
        tapered_prism(
            skeleton.points[p], skeleton.points[k], float(skeleton.radius[p]), float(skeleton.radius[k])
        )
        for k, p in enumerate(skeleton.parent)
        if p >= 0
    ]
    return TreeModel(
        name=name,
        height=float(skeleton.points[:, 1].max()),
        skeleton=skeleton,
        wood=join_meshes(prisms),
        bark=bark_material(seed=seed),
        foliage=scatter_leaves(skeleton, leaf_count, seed) if leaf_count else None,
    )


def bare_tree(name: str = "Winter") -> TreeModel:
    """A small tree without leaves."""
    return hand_made_tree(0, name=name)


def unusual_tree(name: str = "Odd") -> TreeModel:
    """Odd counts everywhere: one wood triangle, one leaf, a 1 x 3 texture, vertex colours on both."""
    tree = hand_made_tree(1, name=name)
    assert tree.foliage is not None
    triangle = TreeMesh(
        positions=np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], np.float32),
        normals=np.zeros((3, 3), np.float32),
        uvs=np.zeros((3, 2), np.float32),
        triangles=np.array([[0, 1, 2]], np.int32),
        colors=np.array([[0, 0, 0], [0.5, 0, 0], [1, 0, 0.25]], np.float32),
    )
    picture = np.array([[[1, 2, 3], [200, 100, 50], [255, 255, 255]]], np.uint8)
    leaf = dataclasses.replace(leaf_quad(), colors=np.full((4, 3), 0.25, np.float32))
    return dataclasses.replace(
        tree,
        wood=triangle,
        bark=Material("speck", picture),
        foliage=dataclasses.replace(tree.foliage, leaf=leaf),
    )
