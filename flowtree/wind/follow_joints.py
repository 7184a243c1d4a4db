"""One armature for a tree's coarser levels."""

from __future__ import annotations

import dataclasses

import numpy as np
from scipy.spatial import cKDTree

from flowtree.model.skeleton import Skeleton
from flowtree.model.wind import Armature


def follow_joints(armature: Armature, bound: Skeleton, thinned: Skeleton) -> Armature:
    """Lets another skeleton of the same tree follow joints that are bound to the first.

    Each node takes the joints of the nearest node of the bound skeleton; where several are as near, of the
    one with the lowest index. Thinned skeletons keep most of their nodes in place.

    Args:
        armature: bound to ``bound``.
        bound: n nodes.
        thinned: m nodes.

    Returns: the same joints (the same arrays) for ``thinned``.
    """
    distance, index = cKDTree(bound.points.astype(np.float64)).query(
        thinned.points.astype(np.float64), k=min(4, len(bound.parent))
    )
    distance, index = distance.reshape(len(thinned.parent), -1), index.reshape(len(thinned.parent), -1)
    tied = distance <= distance[:, :1]
    nearest = np.where(tied, index, len(bound.parent)).min(axis=1)
    return dataclasses.replace(armature, joint=armature.joint[nearest], weight=armature.weight[nearest])
