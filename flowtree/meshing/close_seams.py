"""Undoes the split of vertices along texture seams, so that a surface can be checked."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from flowtree.model.mesh import TreeMesh


def close_seams(mesh: TreeMesh) -> tuple[NDArray[np.float32], NDArray[np.int32]]:
    """Merges the vertices that a texture seam or a pointed tip has split.

    A mesh carries one vertex per texture coordinate, so a closed surface has a slit along its seam. Vertices
    of one connected piece whose positions are equal to the last bit are one vertex here; vertices of
    different pieces (two twigs that happen to coincide) stay apart, or closed pieces would seem to be joined.

    Returns: positions (n, 3) [m] and triangles (m, 3) of the same surface without texture coordinates.
    """
    n = len(mesh.positions)
    edges = np.concatenate([mesh.triangles[:, [0, 1]], mesh.triangles[:, [1, 2]]])
    graph = coo_matrix((np.ones(len(edges), np.int8), (edges[:, 0], edges[:, 1])), shape=(n, n))
    _, piece = connected_components(graph, directed=False)
    key = np.column_stack([mesh.positions.astype(np.float64), piece])
    order = np.lexsort(key.T)
    fresh = np.any(key[order][1:] != key[order][:-1], axis=1)
    label = np.empty(n, np.int32)
    label[order] = np.concatenate([[0], np.cumsum(fresh)]) if n else []
    positions = np.empty((int(label.max(initial=-1)) + 1, 3), np.float32)
    positions[label] = mesh.positions
    return positions, label[mesh.triangles]


def is_watertight(triangles: NDArray[np.int32]) -> bool:
    """Whether every edge is used exactly twice, once in each direction, and no triangle has lost a corner.

    Args:
        triangles: (m, 3), from `close_seams`.
    """
    flat = triangles.astype(np.int64)
    if len(flat) == 0 or np.any(flat == np.roll(flat, 1, axis=1)):
        return False
    start, end = flat.ravel(), np.roll(flat, -1, axis=1).ravel()
    base = int(flat.max()) + 1
    forward, count = np.unique(start * base + end, return_counts=True)
    return bool(np.all(count == 1)) and np.array_equal(forward, np.sort(end * base + start))
