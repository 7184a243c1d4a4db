"""Undoes the split of vertices along texture seams, so that a surface can be checked."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from flowtree.model.mesh import TreeMesh

Ints = NDArray[np.int64]


def close_seams(mesh: TreeMesh) -> tuple[NDArray[np.float32], NDArray[np.int32]]:
    """Merges the vertices that a texture seam or a pointed tip has split.

    A mesh carries one vertex per texture coordinate, so a closed surface has slits. Vertices whose positions
    are equal to the last bit are one vertex here, if they belong to one connected piece, or if both lie on a
    slit that is still open then. Other vertices stay apart, even where two twigs happen to coincide: merged,
    closed pieces would seem to be joined.

    Returns: positions (n, 3) [m] and triangles (m, 3) of the same surface without texture coordinates.
    """
    triangles = mesh.triangles.astype(np.int64)
    count = len(mesh.positions)
    start, end = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    graph = coo_matrix((np.ones(len(start), np.int8), (start, end)), shape=(count, count))
    _, piece = connected_components(graph, directed=False)
    label, first = _merge(mesh.positions, piece.astype(np.int64))

    start, end = label[start], label[end]
    edge = np.minimum(start, end) * count + np.maximum(start, end)
    order = np.argsort(edge)
    differs = np.diff(edge[order]) != 0
    alone = np.concatenate([[True], differs])[: len(order)] & np.append(differs, True)[: len(order)]
    open_edge = order[alone]
    # Vertices inside a surface get a group of their own, so that only those on open slits can meet.
    group = 1 + np.arange(len(first))
    group[start[open_edge]] = 0
    group[end[open_edge]] = 0
    joined, kept = _merge(mesh.positions[first], group)
    return mesh.positions[first[kept]], joined[label][mesh.triangles].astype(np.int32)


def _merge(positions: NDArray[np.float32], group: Ints) -> tuple[Ints, Ints]:
    """Numbers vertices (n,), alike for equal positions of one group; and names one vertex a number."""
    order = np.lexsort((*positions.T, group))
    same = (positions[order][1:] == positions[order][:-1]).all(axis=1) & (np.diff(group[order]) == 0)
    fresh = np.concatenate([[True], ~same])[: len(order)]
    label = np.empty(len(order), np.int64)
    label[order] = np.cumsum(fresh) - 1
    return label, order[fresh]
