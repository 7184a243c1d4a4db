"""Joints and weights of vertices, for skinning."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flowtree.model.skeleton import Skeleton
from flowtree.model.wind import Armature
from flowtree.wind.place_on_segments import place_on_segments


def skin_vertices(
    skeleton: Skeleton, armature: Armature, node: NDArray[np.int32], positions: NDArray[np.float32]
) -> tuple[NDArray[np.uint16], NDArray[np.float32]]:
    """Blends the joints of both ends of the segment that carries each vertex.

    Args:
        skeleton: n nodes.
        armature: bound to it.
        node: (v,) which segment carries each vertex.
        positions: (v, 3) [m], at rest.

    Returns:
        ``JOINTS_0`` (v, 4), each joint of a vertex once, the heaviest first, 0 where the weight is 0; and
        ``WEIGHTS_0`` (v, 4), which sum to 1.

    Raises:
        InputError: a node that the skeleton has not, or not one for each vertex.
    """
    share = place_on_segments(skeleton, node, positions)[:, None]
    above = np.maximum(skeleton.parent[node], 0)
    joint = np.concatenate([armature.joint[node], armature.joint[above]], axis=1).astype(np.int64)
    weight = np.concatenate([share * armature.weight[node], (1 - share) * armature.weight[above]], axis=1)
    weight = weight.astype(np.float64)
    for later in range(1, 4):
        for earlier in range(later):
            same = joint[:, later] == joint[:, earlier]
            weight[same, earlier] += weight[same, later]
            weight[same, later] = 0.0
    order = np.argsort(-weight, axis=1, kind="stable")
    joint, weight = np.take_along_axis(joint, order, axis=1), np.take_along_axis(weight, order, axis=1)
    weights = (weight / weight.sum(axis=1, keepdims=True)).astype(np.float32)
    return np.where(weights > 0, joint, 0).astype(np.uint16), weights
