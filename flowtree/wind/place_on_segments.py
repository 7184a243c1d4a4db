"""Where along the skeleton's segments points stand."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flowtree import check
from flowtree.geometry.polylines import nearest_on_segments
from flowtree.model.skeleton import Skeleton


def place_on_segments(
    skeleton: Skeleton, node: NDArray[np.int32], positions: NDArray[np.float32]
) -> NDArray[np.float32]:
    """How far along its segment each point stands: 0 at the node's parent, 1 at the node.

    Args:
        skeleton: world frame [m].
        node: (v,) which segment carries each point.
        positions: (v, 3) [m]; points beside their segment count as the nearest place on it.

    Returns: (v,) float32 in 0..1; 0 on segments without length.

    Raises:
        InputError: a node that the skeleton has not, or not one for each point.
    """
    known = check.array(
        node, "carrying nodes", shape=(len(positions),), dtype=np.int32, low=0, high=len(skeleton.parent) - 1
    )
    above = np.maximum(skeleton.parent[known], 0)
    share, _ = nearest_on_segments(positions, skeleton.points[above], skeleton.points[known])
    return share.astype(np.float32)
