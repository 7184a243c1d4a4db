"""Fewer vertices for branches too thin to show where their bark begins and ends."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from flowtree.model.mesh import TreeMesh
from flowtree.model.skeleton import Skeleton

THIN = 0.001  # of the height: radius up to which nobody sees where the bark's texture begins
_SAME_NORMAL = 0.98  # cosine between normals of one place that may be one


def weld_thin_wood(wood: TreeMesh, skeleton: Skeleton, *, radius: float) -> TreeMesh:
    """Merges vertices of thin branches that differ in texture coordinates alone.

    A ring repeats its first vertex where the texture ends, and a tip has one for each side. On a branch
    thinner than the bark's relief that is a third of all vertices for nothing: there the texture may run
    back over the last side, and gather at the tip. Where two triangles would become one, seen from both
    sides, both stay as they are.

    Args:
        wood: whose vertices know their node; any other stays as it is.
        skeleton: of that wood.
        radius: of branches that are thin, at most [m].

    Returns: the same places and triangles, of fewer vertices.
    """
    if wood.node is None or not len(wood.positions):
        return wood
    thin = np.flatnonzero(skeleton.radius[wood.node] <= radius)
    keys = np.column_stack([wood.positions[thin] + np.float32(0), wood.node[thin].astype(np.float32)])
    rows = np.ascontiguousarray(keys).view([("", np.void, keys.itemsize * keys.shape[1])]).ravel()
    _, first, group = np.unique(rows, return_index=True, return_inverse=True)
    stands = np.arange(len(wood.positions))
    alike = (wood.normals[thin] * wood.normals[thin[first[group]]]).sum(axis=1) > _SAME_NORMAL
    stands[thin[alike]] = thin[first[group[alike]]]
    stands = _keep_sides_apart(wood.triangles, stands)
    kept = np.flatnonzero(stands == np.arange(len(stands)))
    place = np.empty(len(stands), np.int32)
    place[kept] = np.arange(len(kept))
    return replace(
        wood,
        positions=wood.positions[kept],
        normals=wood.normals[kept],
        uvs=wood.uvs[kept],
        triangles=place[stands[wood.triangles]],
        colors=None if wood.colors is None else wood.colors[kept],
        tangents=None if wood.tangents is None else wood.tangents[kept],
        node=wood.node[kept],
    )


def _keep_sides_apart(triangles: NDArray[np.int32], stands: NDArray[np.int64]) -> NDArray[np.int64]:
    """Undoes what makes two triangles of the same vertices, or one without area: many programs drop such.

    Of each such triangle one corner is left alone, the last: the tip of a blade has a vertex for either side.
    """
    apart = stands.copy()
    while True:
        corners = np.sort(apart[triangles], axis=1)
        order = np.lexsort(corners.T)
        twin = (corners[order[1:]] == corners[order[:-1]]).all(axis=1)
        bad = (corners[:, 1:] == corners[:, :-1]).any(axis=1)
        bad[order[1:][twin]] = True
        moved = np.where(apart[triangles] != triangles, triangles, -1)
        last = moved[bad | np.isin(np.arange(len(bad)), order[:-1][twin])].max(axis=1, initial=-1)
        last = last[last >= 0]
        if not len(last):
            return apart
        apart[last] = last
