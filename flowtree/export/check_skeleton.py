"""The border of the skeleton writers: what a skeleton must be before it becomes a file."""

from __future__ import annotations

import numpy as np

from flowtree import check
from flowtree.model.skeleton import Skeleton

# Nothing that grows is larger; it keeps every number and every difference far inside float32.
MOST_METRES = 1e6


def check_skeleton(skeleton: Skeleton) -> None:
    """Refuses a skeleton that would make a file nobody can read.

    Raises:
        InputError: no node, arrays of different length, NaN, a number beyond `MOST_METRES`, or a parent that
            does not come before its child.
    """
    count = len(skeleton.parent)
    check.require(count > 0, "skeleton", "needs a node", "none", "trace it first")
    check.array(skeleton.points, "skeleton's points", shape=(count, 3), low=-MOST_METRES, high=MOST_METRES)
    check.array(skeleton.radius, "skeleton's radii", shape=(count,), low=0.0, high=MOST_METRES)
    for name in ("particles", "level", "twig"):
        check.array(getattr(skeleton, name), f"skeleton's {name}", shape=(count,), dtype=np.int64)
    parent = check.array(skeleton.parent, "skeleton's parents", shape=(count,), dtype=np.int64)
    ordered = parent[0] == -1 and bool(((parent[1:] >= 0) & (parent[1:] < np.arange(1, count))).all())
    check.require(
        ordered,
        "skeleton's parents",
        "must start with the root, -1, and name earlier nodes",
        "another order",
        "sort the nodes parents first",
    )
