"""Which nodes of a tree's finest skeleton the nodes of a thinned one are."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from flowtree.model.skeleton import Skeleton

_SHARERS = 8  # nodes looked at that may share a place


def match_nodes(finest: Skeleton, thinned: Skeleton) -> NDArray[np.int64]:
    """The nearest node of the finest skeleton for each node of the thinned one.

    Thinned skeletons keep their nodes in place. Where several nodes share a place (a twig that leaves where a
    branch's node is), those of the same branching order go first, then the lowest index.

    Args:
        finest: n nodes.
        thinned: m nodes.

    Returns: (m,) in 0..n-1.
    """
    count = min(_SHARERS, len(finest.parent))
    distance, index = cKDTree(finest.points.astype(np.float64)).query(
        thinned.points.astype(np.float64), k=count
    )
    distance, index = distance.reshape(-1, count), index.reshape(-1, count).astype(np.int64)
    other = finest.level[index] != thinned.level[:, None]
    order = np.lexsort((index, other, distance), axis=1)
    best: NDArray[np.int64] = np.take_along_axis(index, order[:, :1], axis=1)[:, 0]
    return best
