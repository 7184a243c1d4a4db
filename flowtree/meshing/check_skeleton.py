"""What every surface asks of a skeleton."""

from __future__ import annotations

import numpy as np

from flowtree import check
from flowtree.model.skeleton import Skeleton


def check_skeleton(skeleton: Skeleton) -> None:
    """Checks what comes from outside before it is covered with a surface.

    Raises:
        InputError: fewer than two nodes; lengths that differ; a parent that does not come before its child;
            NaN; a negative radius.
    """
    n = len(skeleton.parent)
    check.require(n >= 2, "skeleton", "needs two nodes or more", n, "trace more particles")
    check.array(skeleton.points, "skeleton points", shape=(n, 3))
    check.array(skeleton.radius, "skeleton radius", shape=(n,), low=0.0)
    check.array(skeleton.particles, "skeleton particles", shape=(n,), dtype=np.int32)
    parent = check.array(skeleton.parent, "skeleton parent", shape=(n,), dtype=np.int32)
    before = parent[0] == -1 and bool(np.all((parent[1:] >= 0) & (parent[1:] < np.arange(1, n))))
    check.require(
        before,
        "skeleton parent",
        "must be -1 at node 0 alone and come before its child",
        "another order",
        "sort the nodes from the root to the tips",
    )
