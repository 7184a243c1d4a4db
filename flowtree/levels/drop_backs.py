"""Twigs without thickness as single sheets, half of their triangles."""

from __future__ import annotations

import numpy as np

from flowtree.model.mesh import TreeMesh

_FACTORS = np.array([0x9E3779B97F4A7C15, 0xC2B2AE3D27D4EB4F, 0x165667B19E3779F9], np.uint64)


def drop_backs(wood: TreeMesh) -> TreeMesh:
    """The mesh without triangles that lie on another one, seen from behind: for a material with two sides.

    Where a branch is thinner than its budget of triangles can show, `sweep_rings` makes a blade of it, with a
    front and a back: two triangles in one place. From either side a shader shows one of them alike.

    Returns: the same places, seen from all sides; vertices that nothing uses any more are gone.
    """
    bits = (wood.positions + np.float32(0)).view(np.uint32).astype(np.uint64)  # of two zeros one
    place = (bits * _FACTORS).sum(axis=1)
    corners = np.sort(place[wood.triangles], axis=1)
    order = np.lexsort(corners.T)
    twin = (corners[order[1:]] == corners[order[:-1]]).all(axis=1)
    kept = np.ones(len(corners), np.bool_)
    kept[order[1:][twin]] = False
    if kept.all():
        return wood
    used = np.zeros(len(wood.positions), np.bool_)
    used[wood.triangles[kept]] = True

    number = np.cumsum(used) - 1
    return TreeMesh(
        positions=wood.positions[used],
        normals=wood.normals[used],
        uvs=wood.uvs[used],
        triangles=number[wood.triangles[kept]].astype(np.int32),
        colors=None if wood.colors is None else wood.colors[used],
        tangents=None if wood.tangents is None else wood.tangents[used],
        node=None if wood.node is None else wood.node[used],
    )
