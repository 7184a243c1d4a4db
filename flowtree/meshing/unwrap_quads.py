"""Quads as textured triangles for files and pictures."""

from __future__ import annotations

import numpy as np

from flowtree.meshing.branch_axes import Floats, Ints
from flowtree.model.mesh import QuadMesh, TreeMesh


def unwrap_quads(mesh: QuadMesh) -> TreeMesh:
    """Cuts quads in two along their shorter diagonals and splits vertices where texture coordinates differ.

    Normals are shared across seams: each is the mean of its quads' normals, weighted by area. Tangents point
    toward growing u; the bitangent, their cross product with the normal, points up the texture.

    Returns: as many triangles as twice the quads; `close_seams` merges its vertices to the closed surface.
    """
    quads = mesh.quads.astype(np.int64)
    points = mesh.positions.astype(np.float64)
    corner = points[quads]
    diagonal = corner[:, 2] - corner[:, 0], corner[:, 3] - corner[:, 1]
    area = np.cross(*diagonal)
    count = len(points)
    normals = _unit_or(_sum_at(quads, np.repeat(area[:, None], 4, axis=1), count), np.array([0.0, 1.0, 0.0]))

    vertex, corner_vertex = _split(quads, mesh.uvs)
    toward = _toward_growing_u(corner, mesh.uvs.astype(np.float64), area)
    tangent = _sum_at(corner_vertex, np.repeat(toward[:, None], 4, axis=1), len(vertex))
    normals = normals[vertex]
    tangent -= np.sum(tangent * normals, axis=1, keepdims=True) * normals
    lost = np.linalg.norm(tangent, axis=1) < 1e-12
    flat = np.eye(3)[np.argmin(np.abs(normals[lost]), axis=1)]
    tangent[lost] = flat - np.sum(flat * normals[lost], axis=1, keepdims=True) * normals[lost]
    tangents = np.ones((len(vertex), 4), np.float32)
    tangents[:, :3] = _unit_or(tangent, np.array([1.0, 0.0, 0.0]))

    uvs = np.empty((len(vertex), 2), np.float32)
    uvs[corner_vertex] = mesh.uvs
    short = np.sum(diagonal[0] ** 2, axis=1) <= np.sum(diagonal[1] ** 2, axis=1)
    cut = np.where(short[:, None], [0, 1, 2, 0, 2, 3], [0, 1, 3, 1, 2, 3])
    triangles = np.take_along_axis(corner_vertex, cut, axis=1).reshape(-1, 3)
    return TreeMesh(
        positions=mesh.positions[vertex],
        normals=normals.astype(np.float32),
        uvs=uvs,
        triangles=triangles.astype(np.int32),
        tangents=tangents,
        node=mesh.node[vertex],
    )


def _split(quads: Ints, uvs: np.ndarray) -> tuple[Ints, Ints]:
    """Vertices that have one texture coordinate each: the old one (k,), and the corners' (m, 4)."""
    flat, pairs = quads.ravel(), np.ascontiguousarray(uvs.reshape(-1, 2))
    count = int(flat.max()) + 1
    # One corner stands for its vertex; only the few that differ from it, at seams, need sorting.
    example = np.empty(count, np.int64)
    example[flat[::-1]] = np.arange(len(flat))[::-1]
    differs = np.flatnonzero((pairs != pairs[example[flat]]).any(axis=1))
    order = differs[np.lexsort((*pairs[differs].T, flat[differs]))]
    fresh = np.concatenate(
        ([True], (flat[order][1:] != flat[order][:-1]) | (pairs[order][1:] != pairs[order][:-1]).any(axis=1))
    )[: len(order)]
    corner = flat.copy()
    corner[order] = count + np.cumsum(fresh) - 1
    return np.concatenate([np.arange(count), flat[order[fresh]]]), corner.reshape(-1, 4)


def _toward_growing_u(corner: Floats, uvs: Floats, area: Floats) -> Floats:
    """(m, 3) the direction in which u grows on each quad, as long as the quad's area asks for."""
    e, f = corner[:, 2] - corner[:, 0], corner[:, 3] - corner[:, 1]
    g, h = uvs[:, 2] - uvs[:, 0], uvs[:, 3] - uvs[:, 1]
    way = h[:, 1, None] * e - g[:, 1, None] * f
    turn = np.sign(g[:, 0] * h[:, 1] - g[:, 1] * h[:, 0])
    way *= turn[:, None]
    size = np.linalg.norm(way, axis=1, keepdims=True)
    scale = np.divide(
        np.linalg.norm(area, axis=1, keepdims=True), size, out=np.zeros_like(size), where=size > 0
    )
    scaled: Floats = way * scale
    return scaled


def _sum_at(place: Ints, values: Floats, count: int) -> Floats:
    """(count, 3) the sum of the corners' values (m, 4, 3) at their vertices (m, 4)."""
    flat = place.ravel()
    columns = [np.bincount(flat, values[..., k].ravel(), count) for k in range(3)]
    return np.stack(columns, axis=1)


def _unit_or(vectors: Floats, other: Floats) -> Floats:
    """Vectors (n, 3) of length 1; those without a length become the other."""
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    scaled = np.divide(vectors, length, out=np.zeros_like(vectors), where=length > 1e-30)
    return np.where(length > 1e-30, scaled, other)
