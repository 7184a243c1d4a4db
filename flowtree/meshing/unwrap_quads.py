"""Quads as textured triangles for files and pictures."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flowtree.geometry.catmull_clark import split_corners
from flowtree.meshing.branch_axes import Floats, Ints
from flowtree.model.mesh import QuadMesh, TreeMesh


def unwrap_quads(mesh: QuadMesh) -> TreeMesh:
    """Cuts quads in two along their shorter diagonals and splits vertices where texture coordinates differ.

    Normals are shared across seams: each is the mean of its quads' normals, weighted by area. Tangents point
    toward growing u; the bitangent, their cross product with the normal, points up the texture.

    Returns: as many triangles as twice the quads; `close_seams` merges its vertices to the closed surface.
    """
    quads = mesh.quads.astype(np.int64)
    points = [mesh.positions[:, k].astype(np.float64) for k in range(3)]
    first, second = ([p[quads[:, k + 2]] - p[quads[:, k]] for p in points] for k in (0, 1))
    area = [first[k - 2] * second[k - 1] - first[k - 1] * second[k - 2] for k in range(3)]
    normals = _unit_or(_sum_at(quads, area, len(mesh.positions)), np.array([0.0, 1.0, 0.0]))

    vertex, corner_vertex = split_corners(quads, mesh.uvs)
    toward = _toward_growing_u(first, second, mesh.uvs, area)
    tangent = _sum_at(corner_vertex, toward, len(vertex))
    normals = normals[vertex]
    tangent -= np.sum(tangent * normals, axis=1, keepdims=True) * normals
    lost = np.linalg.norm(tangent, axis=1) < 1e-12
    flat = np.eye(3)[np.argmin(np.abs(normals[lost]), axis=1)]
    tangent[lost] = flat - np.sum(flat * normals[lost], axis=1, keepdims=True) * normals[lost]
    tangents = np.ones((len(vertex), 4), np.float32)
    tangents[:, :3] = _unit_or(tangent, np.array([1.0, 0.0, 0.0]))

    uvs = np.empty((len(vertex), 2), np.float32)
    uvs[corner_vertex] = mesh.uvs
    one, two = (np.asarray(sum(k**2 for k in diagonal), np.float64) for diagonal in (first, second))
    short = _without_twins(quads, one <= two)
    triangles = corner_vertex[:, [0, 1, 2, 0, 2, 3]]
    triangles[~short] = corner_vertex[~short][:, [0, 1, 3, 1, 2, 3]]
    return TreeMesh(
        positions=mesh.positions[vertex],
        normals=normals.astype(np.float32),
        uvs=uvs,
        triangles=triangles.reshape(-1, 3).astype(np.int32),
        tangents=tangents,
        node=mesh.node[vertex],
    )


def _without_twins(quads: Ints, short: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Which quads (m,) to cut along their first diagonals, where two do not share the one asked for.

    Two quads at a vertex that no third one has share a diagonal: cut there, four triangles would meet.
    """
    one, two = (np.where(short, quads[:, k], quads[:, k + 1]) for k in (0, 2))
    cut = np.minimum(one, two) * (int(quads.max(initial=0)) + 1) + np.maximum(one, two)
    ordered = np.sort(cut)
    twins = ordered[1:][ordered[1:] == ordered[:-1]]
    return short ^ np.isin(cut, twins) if len(twins) else short


def _toward_growing_u(
    first: list[Floats], second: list[Floats], uvs: NDArray[np.float32], area: list[Floats]
) -> list[Floats]:
    """x, y and z (m,) of the direction in which u grows on each quad, as long as the quad is large."""
    g, h = ([(uvs[:, k + 2, axis] - uvs[:, k, axis]).astype(np.float64) for axis in (0, 1)] for k in (0, 1))
    turn = np.sign(g[0] * h[1] - g[1] * h[0])
    way = [turn * (h[1] * e - g[1] * f) for e, f in zip(first, second, strict=True)]
    size, whole = (np.sqrt(sum(k**2 for k in vector)) for vector in (way, area))
    scale = np.divide(whole, size, out=np.zeros_like(size), where=size > 0)
    return [k * scale for k in way]


def _sum_at(place: Ints, values: list[Floats], count: int) -> Floats:
    """(count, 3) the sums over the quads (m, 4) that meet at a vertex of their x, y and z (m,)."""
    columns = [sum(np.bincount(place[:, k], value, count) for k in range(4)) for value in values]
    return np.stack(columns, axis=1)


def _unit_or(vectors: Floats, other: Floats) -> Floats:
    """Vectors (n, 3) of length 1; those without a length become the other."""
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    scaled = np.divide(vectors, length, out=np.zeros_like(vectors), where=length > 1e-30)
    return np.where(length > 1e-30, scaled, other)
