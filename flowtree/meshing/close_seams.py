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

    A mesh carries one vertex per texture coordinate, so a closed surface has slits. Vertices on slits whose
    positions are equal to the last bit are one vertex here, if they belong to one connected piece, or if both
    lie on a slit that is still open then. Other vertices stay apart, even where two twigs happen to coincide:
    merged, closed pieces would seem to be joined.

    Returns: positions (n, 3) [m] and triangles (m, 3) of the same surface without texture coordinates.
    """
    triangles = mesh.triangles.astype(np.int64)
    count = len(mesh.positions)
    start, end = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    graph = coo_matrix((np.ones(len(start), np.int8), (start, end)), shape=(count, count))
    _, piece = connected_components(graph, directed=False)
    slit = _on_slits(triangles, count)
    label = np.arange(count)
    label[slit] = _first_alike(mesh.positions, slit, piece[slit])

    slit = _on_slits(label[triangles], count)
    across = np.arange(count)
    across[slit] = _first_alike(mesh.positions, slit, np.zeros(len(slit), np.int64))
    label = across[label]
    kept = np.flatnonzero(label == np.arange(count))
    place = np.empty(count, np.int32)
    place[kept] = np.arange(len(kept))
    return mesh.positions[kept], place[label[mesh.triangles]]


def _on_slits(triangles: Ints, count: int) -> Ints:
    """The vertices, growing, of edges that only one triangle has."""
    start, end = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    edge = np.sort(np.minimum(start, end) * count + np.maximum(start, end))
    differs = np.diff(edge) != 0
    alone = np.concatenate([[True], differs])[: len(edge)] & np.append(differs, True)[: len(edge)]
    found = np.zeros(count, np.bool_)
    found[np.concatenate(np.divmod(edge[alone], count))] = True
    return np.flatnonzero(found)


def _first_alike(positions: NDArray[np.float32], chosen: Ints, group: Ints) -> Ints:
    """For each chosen vertex (k,) the first of the chosen ones of its position and group (k,)."""
    order = np.lexsort((*positions[chosen].T, group))
    place = positions[chosen][order]
    same = (place[1:] == place[:-1]).all(axis=1) & (np.diff(group[order]) == 0)
    fresh = np.concatenate([[True], ~same])[: len(order)]
    first = np.empty(len(order), np.int64)
    first[order] = order[np.flatnonzero(fresh)][np.cumsum(fresh) - 1]
    return np.asarray(chosen[first], np.int64)
