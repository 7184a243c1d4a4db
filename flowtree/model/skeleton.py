"""The tree's 3D skeleton."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Skeleton:
    """A rooted tree of branch segments, world frame; segment i runs from ``parent[i]`` to i.

    Attributes:
        parent: (n,) int32, ``parent[i] < i``; the root alone has -1.
        points: (n, 3) float32 [m], the root at the origin.
        radius: (n,) float32 [m], at the node.
        particles: (n,) int32, how many particles were combined to form the segment; twigs added later have 1.
        level: (n,) int32, branching order of the branch a node belongs to: 0 the trunk, counted at each fork
            where a side branch leaves the thicker one.
        twig: (n,) bool, true where the node was placed by the twig rule, not traced by particles.
    """

    parent: NDArray[np.int32]
    points: NDArray[np.float32]
    radius: NDArray[np.float32]
    particles: NDArray[np.int32]
    level: NDArray[np.int32]
    twig: NDArray[np.bool_]
