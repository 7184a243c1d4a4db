"""What the particles left behind."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class FlowTraces:
    """The paths of all particles, joined into one tree (Particle Flows, section 6).

    Attributes:
        parent: (n,) int32, the next point on the way to the foot; ``parent[i] < i``, the root alone has -1.
        points: (n, 3) float32 [m].
        particles: (n,) int32, how many particles passed the point.
        step: (n,) int32, the step of the simulation in which the point was recorded; falls toward the tips.
    """

    parent: NDArray[np.int32]
    points: NDArray[np.float32]
    particles: NDArray[np.int32]
    step: NDArray[np.int32]
