"""How a tree moves in the wind: weights of its nodes and vertices, joints, and a swaying of the joints."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class WindWeights:
    """How the wind moves each of n skeleton nodes, world frame, in three tiers: stem, limb, finer branches.

    The stem turns around the foot, a limb also around the place where it leaves the stem, and all finer
    branches on it also around the place where they leave the limb. Along its segment a node's extents run
    from its parent's to its own; its pivots and phases hold for the whole segment.

    Attributes:
        depth: (n,) int32, the tier of the branch that the node belongs to: 0 the stem, 1 a limb, 2 all finer.
        pivot: (n, 2, 3) float32 [m], where the node's limb leaves the stem, and where its finer branch leaves
            the limb; of a tier that the node has not: the pivot before, the foot for the stem's nodes.
        extent: (n, 3) float32 in 0..1, how far stem, limb and finer branch have bent on the way to the node:
            0 at each pivot, growing toward the tips; finer branches keep their limb's where they leave it.
        phase: (n, 2) float32 in 0..1, of limb and finer branch: where in the cycle its swinging begins.
    """

    depth: NDArray[np.int32]
    pivot: NDArray[np.float32]
    extent: NDArray[np.float32]
    phase: NDArray[np.float32]


@dataclass(frozen=True)
class VertexWind:
    """The same for each of v vertices, and what only vertices have.

    Attributes:
        depth: (v,) int32, as in `WindWeights`.
        pivot: (v, 2, 3) float32 [m], as there.
        extent: (v, 4) float32 in 0..1: of stem, limb, finer branch; and how far a leaf flutters: the distance
            from its stalk's end, relative to the length of the largest leaf.
        phase: (v, 3) float32 in 0..1, of limb, finer branch and leaf.
    """

    depth: NDArray[np.int32]
    pivot: NDArray[np.float32]
    extent: NDArray[np.float32]
    phase: NDArray[np.float32]


@dataclass(frozen=True)
class Armature:
    """Joints, and which of them move the skeleton's n nodes.

    Attributes:
        parent: (j,) int32, ``parent[i] < i``; the root joint alone has -1.
        points: (j, 3) float32 [m], world frame, at rest; joints are not rotated at rest.
        node: (j,) int32, the first skeleton node that the joint turns: it stands at that node's parent.
        joint: (n, 2) int32, the two joints of each skeleton node.
        weight: (n, 2) float32, how much each counts; they sum to 1, and where one is 0 its joint is 0.
    """

    parent: NDArray[np.int32]
    points: NDArray[np.float32]
    node: NDArray[np.int32]
    joint: NDArray[np.int32]
    weight: NDArray[np.float32]


@dataclass(frozen=True)
class Sway:
    """A motion of the joints that ends as it begins.

    Attributes:
        name: of the motion.
        times: (k,) float32 [s], from 0, growing.
        rotation: (k, j, 4) float32, unit quaternions (x, y, z, w) of each joint relative to its parent; the
            last row equals the first.
    """

    name: str
    times: NDArray[np.float32]
    rotation: NDArray[np.float32]


@dataclass(frozen=True)
class Wind:
    """All that moves one tree.

    The vertex attributes are ready for a glTF file: by name, as arrays of v rows and as many columns as the
    accessor's type has (1 to 4). float32 is written as it is, uint8 and uint16 as normalised integers, but
    ``JOINTS_0`` (uint16) as plain ones. Where there is a ``COLOR_0`` it stands in place of the mesh's
    colours, whose mean then belongs into the material's factor.

    Attributes:
        weights: for shaders.
        armature: for skinning; None where only shaders are served.
        sway: of the armature's joints; None where it stands still.
        wood: attributes of the wood's vertices.
        leaves: attributes of the leaves' vertices once they are merged: leaf k owns the k-th run of them.
    """

    weights: WindWeights
    armature: Armature | None = None
    sway: Sway | None = None
    wood: Mapping[str, NDArray[Any]] = field(default_factory=dict)
    leaves: Mapping[str, NDArray[Any]] = field(default_factory=dict)
