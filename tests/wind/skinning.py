"""Linear blend skinning, as every engine does it, in numpy."""

from __future__ import annotations

import numpy as np

from flowtree.model.wind import Armature


def rotations(quaternions):
    """(j, 4) as (x, y, z, w) to (j, 3, 3)."""
    x, y, z, w = np.asarray(quaternions, float).T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.array(rows).transpose(2, 0, 1)


def pose(armature: Armature, quaternions, positions, joints, weights):
    """Where the vertices (v, 3) go when the joints turn by (j, 4); joints and weights are (v, k)."""
    turns, points = rotations(quaternions), armature.points.astype(float)
    world, place = np.empty_like(turns), np.empty_like(points)
    for joint, parent in enumerate(armature.parent):
        up = np.eye(3) if parent < 0 else world[parent]
        base = points[joint] if parent < 0 else place[parent] + up @ (points[joint] - points[parent])
        world[joint], place[joint] = up @ turns[joint], base
    arms = np.asarray(positions, float)[:, None, :] - points[joints]
    moved = place[joints] + np.einsum("vkij,vkj->vki", world[joints], arms)
    return np.einsum("vk,vki->vi", np.asarray(weights, float), moved)
