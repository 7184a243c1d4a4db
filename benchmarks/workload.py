"""The workload on which flowtree's particle kernels and their peers are compared, and what its result is.

All programs compute the following in float32. Particles lie uniformly in the upper 70 % of the unit cube,
x and z in [-0.5, 0.5], y in [0, 1]; the foot is the origin. Two direction fields of 100 x 100 cells, seen
from the front and from the side, hold unit vectors along ``(-4 (u - s(v)), -1)`` with
``s(v) = 0.05 v sin(9 v + phase)``.

* The direction at x is the sum of both views' vectors in the world, bilinear and clamped to the middles of
  the outermost cells, its components averaged over the views that see them, normalised. Near the foot it
  turns into the straight way there: ``wanted = direction * free - x / |x| * (1 - free)`` with
  ``free = min(|x| / BASIN, 1) * clamp(1 + y / BASIN, 0, 1)``.
* The nearest living neighbour, where it was at the beginning of the step, attracts at a distance d in
  (0, radius): ``wanted += gap / d * (1 - d / radius)``.
* The acceleration is ``(wanted - v) * min(1 / (RESPONSE * mass ** INERTIA), 1 / STEP)``; place and
  velocity, 0 at first, follow it by the classical Runge-Kutta method of fourth order.

One step: (1) every living particle finds its nearest living neighbour within the radius, of equally near
ones the lowest particle. (2) Mutual nearest neighbours nearer than the threshold join: the heavier, of equal
mass the lower particle, stays, at the mean place and velocity weighted by mass, with the mass of both, and
feels no attraction in this step; the other ends. (3) All living advance; who is then nearer to the foot than
ARRIVAL ends. Radius and threshold follow the mean spacing of the particles. Steps go on until nobody lives,
at most `MOST_STEPS`.

The places of all living at the beginning of every step are recorded.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

CELLS = 100  # along each side of a field
CELL = 0.01
LEFT = -0.5  # where a field's first column begins; its first row begins at 0
STEP = 0.005
BASIN = 0.05
ARRIVAL = 0.012
RESPONSE = 0.02
INERTIA = 0.15
MOST_STEPS = 1000

_PHASES = (0.0, 1.3)  # of the views' fields


@dataclass(frozen=True)
class Workload:
    """What every program gets.

    start: (n, 3) float32.
    vectors: (2, CELLS, CELLS, 2) float32, the views' fields in their planes (right, up); row 0 is the lowest.
        Right is x in the first view and -z in the second.
    radius: within which neighbours are found and attract.
    threshold: nearer than this mutual nearest neighbours join.
    """

    start: NDArray[np.float32]
    vectors: NDArray[np.float32]
    radius: float
    threshold: float


@dataclass(frozen=True)
class Traced:
    """What every program returns.

    joined: (n,) int32, the particle that it joined; -1 where none.
    end_step: (n,) int32, the step in which it joined or arrived, the last that it is recorded in; -1 where it
        never ended.
    arrived: how many reached the foot.
    particle_steps: sum of the numbers of living particles at the beginnings of all steps: of places recorded.
    records: the recorded places and particles, in whatever form the program keeps them.
    """

    joined: NDArray[np.int32]
    end_step: NDArray[np.int32]
    arrived: int
    particle_steps: int
    records: Any


Program = Callable[[Workload], Traced]


def make_workload(count: int, seed: int = 0) -> Workload:
    """The workload of ``count`` particles; the same for the same seed."""
    random = np.random.default_rng(seed)
    start = random.random((count, 3)) * (1.0, 0.7, 1.0) + (-0.5, 0.3, -0.5)
    middle = (np.arange(CELLS) + 0.5) * CELL
    u, v = np.meshgrid(middle + LEFT, middle)
    fields = []
    for phase in _PHASES:
        field = np.stack([-4.0 * (u - 0.05 * v * np.sin(9.0 * v + phase)), np.full_like(u, -1.0)], axis=-1)
        fields.append(field / np.linalg.norm(field, axis=-1, keepdims=True))
    spacing = (0.7 / max(count, 1)) ** (1 / 3)
    return Workload(
        start=start.astype(np.float32),
        vectors=np.stack(fields).astype(np.float32),
        radius=2.0 * spacing,
        threshold=0.25 * spacing,
    )
