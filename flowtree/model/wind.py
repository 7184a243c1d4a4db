"""How a tree moves in the wind: weights of the skeleton's nodes, joints, and a swaying of the joints."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class WindWeights:
    """What an engine's shader needs to move a branch, for each of n skeleton nodes, world frame.

    A vertex takes the values between its node's parent and its node (see `TreeMesh.node`), a leaf those where
    it stands on its segment.

    Attributes:
        pivot: (n, 3) float32 [m], where the node's branch leaves its parent branch; the foot for the trunk.
        depth: (n,) int32, hierarchy depth of the branch: 0 the stem, 1 a limb, 2 all finer branches.
        extent: (n,) float32 in 0..1, how far the node swings: 0 at the foot, growing toward the tips.
        phase: (n,) float32 in 0..1, one value a branch: where in the cycle its swinging begins.
    """

    pivot: NDArray[np.float32]
    depth: NDArray[np.int32]
    extent: NDArray[np.float32]
    phase: NDArray[np.float32]


@dataclass(frozen=True)
class Armature:
    """Joints, and which of them move the skeleton's nodes.

    Attributes:
        parent: (j,) int32, ``parent[i] < i``; the root joint alone has -1.
        points: (j, 3) float32 [m], world frame, at rest; joints are not rotated at rest.
        joint: (n, 2) int32, the two joints of each skeleton node.
        weight: (n, 2) float32, how much each counts; they sum to 1, and where one is 0 its joint is 0.
    """

    parent: NDArray[np.int32]
    points: NDArray[np.float32]
    joint: NDArray[np.int32]
    weight: NDArray[np.float32]


@dataclass(frozen=True)
class Sway:
    """A motion of the joints that ends as it begins.

    Attributes:
        name: of the motion.
        times: (k,) float32 [s], from 0, growing.
        rotation: (k, j, 4) float32, unit quaternions (x, y, z, w) of each joint relative to its parent.
    """

    name: str
    times: NDArray[np.float32]
    rotation: NDArray[np.float32]


@dataclass(frozen=True)
class Wind:
    """All that moves one tree.

    Attributes:
        weights: for shaders.
        armature: for skinning; None where only shaders are served.
        sway: of the armature's joints; None where it stands still.
    """

    weights: WindWeights
    armature: Armature | None = None
    sway: Sway | None = None
