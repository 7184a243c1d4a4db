"""Leaves: one shape, many places."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flowtree.model.mesh import Material, TreeMesh


@dataclass(frozen=True)
class Foliage:
    """Instances of one leaf (or compound leaf, needle cluster, frond).

    Attributes:
        leaf: the shape, 1 m long: the stalk's end at the origin, the blade along +y, its upper side to +z.
        material: of every leaf.
        position: (n, 3) float32 [m], where the stalk leaves the twig.
        rotation: (n, 4) float32, unit quaternions (x, y, z, w), from the leaf's frame to the world.
        scale: (n,) float32, the leaf's length [m].
        color: (n, 3) float32 in 0..1, linear, multiplied with the texture.
        node: (n,) int32, the skeleton node whose segment carries the leaf.
        rounding: 0..1, how much of the leaves' normals is the way out of the crown where they are shaded.
    """

    leaf: TreeMesh
    material: Material
    position: NDArray[np.float32]
    rotation: NDArray[np.float32]
    scale: NDArray[np.float32]
    color: NDArray[np.float32]
    node: NDArray[np.int32]
    rounding: float = 0.5
