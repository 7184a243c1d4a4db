"""What a tree is to a physics engine."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Collision:
    """Solid bodies in the place of a tree, world frame [m].

    Attributes:
        capsule_ends: (c, 2, 3) float32, both centres of each capsule's round ends, lower first: stem and
            thick limbs.
        capsule_radius: (c,) float32.
        hull_positions: (n, 3) float32, corners of a coarse convex hull of the whole tree; may be empty.
        hull_triangles: (m, 3) int32, counter-clockwise seen from outside.
        thinnest: radius of the thinnest wood that has capsules [m].
    """

    capsule_ends: NDArray[np.float32]
    capsule_radius: NDArray[np.float32]
    hull_positions: NDArray[np.float32]
    hull_triangles: NDArray[np.int32]
    thinnest: float = 0.0
