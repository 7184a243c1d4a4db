"""The 2D skeleton: attractor graph, drawn strokes, sketch."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class AttractorGraph:
    """A rooted tree of line segments in the plane of one view; the one type for every 2D skeleton.

    The plane's axes are image-right and up, in metres, with the foot of the trunk at (0, 0).

    Attributes:
        parent: (n,) int32, ``parent[i] < i``; the root alone has -1.
        points: (n, 2) float32 [m].
    """

    parent: NDArray[np.int32]
    points: NDArray[np.float32]
