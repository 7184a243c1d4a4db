"""Attractors: the 2D skeleton of a view (graph, drawn strokes, sketch), and the limbs in space."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

#: Which way branches grow.
Habit = Literal["upright", "spreading", "weeping", "conifer", "palm"]


@dataclass(frozen=True)
class AttractorGraph:
    """A rooted tree of line segments in the plane of one view; the one type for every 2D skeleton.

    The plane's axes are image-right and up, in metres, with the foot of the trunk at (0, 0).

    Attributes:
        parent: (n,) int32, ``parent[i] < i``; the root alone has -1.
        points: (n, 2) float32 [m].
        half_width: (n,) float32 [m], of what the matte shows along the branches, NaN where a node is not in
            its middle; None where nothing was measured.
    """

    parent: NDArray[np.int32]
    points: NDArray[np.float32]
    half_width: NDArray[np.float32] | None = None


@dataclass(frozen=True)
class LimbTree:
    """The limbs that the views' attractor graphs show, in space; world frame.

    Attributes:
        parent: (n,) int32, ``parent[i] < i``; the root alone has -1.
        points: (n, 3) float32 [m], the root at the origin.
        radius: (n,) float32 [m], as the pictures show it; NaN where they do not.
    """

    parent: NDArray[np.int32]
    points: NDArray[np.float32]
    radius: NDArray[np.float32]
