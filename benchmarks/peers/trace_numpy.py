"""The workload with NumPy, its neighbours from SciPy's k-d tree on all cores."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from benchmarks.workload import (
    ARRIVAL,
    BASIN,
    CELL,
    CELLS,
    INERTIA,
    LEFT,
    MOST_STEPS,
    RESPONSE,
    STEP,
    Traced,
    Workload,
)

_Array = NDArray[np.float32]
_H, _HALF_H, _SIXTH_H = (np.float32(STEP / k) for k in (1, 2, 6))
_NOWHERE = np.float32(1e6)  # too far away to attract


def trace_numpy(workload: Workload) -> Traced:
    """Traces all particles; records are lists of places (m, 3) and of particles (m,), one of each a step.

    The arrays hold the living only, in the order of their numbers.
    """
    count = len(workload.start)
    joined = np.full(count, -1, np.int32)
    end_step = np.full(count, -1, np.int32)
    who = np.arange(count, dtype=np.int32)
    x, v = workload.start.copy(), np.zeros((count, 3), np.float32)
    mass = np.ones(count, np.float32)
    fields = np.ascontiguousarray(workload.vectors.reshape(2, CELLS * CELLS, 2))
    places, particles, arrived = [], [], 0
    for number in range(MOST_STEPS):
        if not len(who):
            break
        places.append(x)
        particles.append(who)
        nearest, distance = _find_nearest(x, workload.radius)
        goal = np.where((nearest >= 0)[:, None], x[nearest], _NOWHERE)
        stays, goes = _pair(nearest, distance, mass, workload.threshold)
        joined[who[goes]], end_step[who[goes]] = who[stays], number
        x, v, mass = x.copy(), v.copy(), mass.copy()
        total = mass[stays] + mass[goes]
        for state in (x, v):
            mean = mass[stays, None] * state[stays] + mass[goes, None] * state[goes]
            state[stays] = mean / total[:, None]
        mass[stays] = total
        goal[stays] = _NOWHERE
        x, v = _advance(fields, x, v, mass, goal, np.float32(workload.radius))
        there = (x * x).sum(axis=1) < np.float32(ARRIVAL**2)
        lives = ~there
        there[goes] = lives[goes] = False
        end_step[who[there]] = number
        arrived += int(there.sum())
        x, v, mass, who = x[lives], v[lives], mass[lives], who[lives]
    return Traced(joined, end_step, arrived, sum(map(len, particles)), (places, particles))


def _find_nearest(x: _Array, radius: float) -> tuple[NDArray[np.intp], _Array]:
    """The nearest other within the radius, and how far it is; -1 and infinity where nobody is.

    Of equally near ones it is whichever the tree finds: to ask for more than two neighbours, of which one is
    the particle itself, would cost more than it mends.
    """
    count = len(x)
    if count < 2:
        return np.full(count, -1), np.full(count, np.inf, np.float32)
    tree = cKDTree(x, balanced_tree=False, compact_nodes=False)
    far, near = tree.query(x, k=2, distance_upper_bound=radius, workers=-1)
    first = (near[:, 0] != np.arange(count)).astype(np.intp)  # 1 where another in the same place comes first
    row = np.arange(count), 1 - first
    nearest, distance = near[row], far[row]
    nearest[np.isinf(distance)] = -1
    return nearest, distance.astype(np.float32)


def _pair(
    nearest: NDArray[np.intp], distance: _Array, mass: _Array, threshold: float
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Who stays and who goes of each pair of mutual nearest neighbours under the threshold."""
    one = np.flatnonzero(distance < threshold)
    other = nearest[one]
    mutual = (nearest[other] == one) & (one < other)
    one, other = one[mutual], other[mutual]
    heavier = mass[one] >= mass[other]
    return np.where(heavier, one, other), np.where(heavier, other, one)


def _advance(
    fields: _Array, x: _Array, v: _Array, mass: _Array, goal: _Array, radius: np.float32
) -> tuple[_Array, _Array]:
    """One step of the classical Runge-Kutta method."""
    rate = np.minimum(1 / (np.float32(RESPONSE) * mass ** np.float32(INERTIA)), 1 / _H)[:, None]

    def acceleration(at: _Array, speed: _Array) -> _Array:
        wanted = _wanted(fields, at)
        gap = goal - at
        distance = np.sqrt((gap * gap).sum(axis=1, keepdims=True))
        pull = (1 - distance / radius) / np.maximum(distance, np.float32(1e-30))
        wanted += gap * np.where((distance > 0) & (distance < radius), pull, np.float32(0))
        return (wanted - speed) * rate

    a1 = acceleration(x, v)
    v2 = v + _HALF_H * a1
    a2 = acceleration(x + _HALF_H * v, v2)
    v3 = v + _HALF_H * a2
    a3 = acceleration(x + _HALF_H * v2, v3)
    v4 = v + _H * a3
    a4 = acceleration(x + _H * v3, v4)
    return x + _SIXTH_H * (v + 2 * v2 + 2 * v3 + v4), v + _SIXTH_H * (a1 + 2 * a2 + 2 * a3 + a4)


def _wanted(fields: _Array, at: _Array) -> _Array:
    """The velocity that the fields and the foot ask for."""
    side, up = _look_up(fields[0], at[:, 0], at[:, 1]).T
    depth, rise = _look_up(fields[1], -at[:, 2], at[:, 1]).T
    total = np.stack([side, np.float32(0.5) * (up + rise), -depth], axis=1)
    total /= np.sqrt((total * total).sum(axis=1, keepdims=True))
    far = np.sqrt((at * at).sum(axis=1))
    free = np.minimum(far / np.float32(BASIN), 1) * np.clip(1 + at[:, 1] / np.float32(BASIN), 0, 1)
    total *= free[:, None]
    total -= at * ((1 - free) / np.maximum(far, np.float32(1e-30)))[:, None]
    return total


def _look_up(field: _Array, u: _Array, v: _Array) -> _Array:
    """Bilinear values of one view's field."""
    u = np.clip((u - np.float32(LEFT)) / np.float32(CELL) - np.float32(0.5), 0, CELLS - 1)
    v = np.clip(v / np.float32(CELL) - np.float32(0.5), 0, CELLS - 1)
    column = np.minimum(u.astype(np.int32), CELLS - 2)
    row = np.minimum(v.astype(np.int32), CELLS - 2)
    a, b = (u - column)[:, None].astype(np.float32), (v - row)[:, None].astype(np.float32)
    at = row * CELLS + column
    low = field[at] * (1 - a) + field[at + 1] * a
    high = field[at + CELLS] * (1 - a) + field[at + CELLS + 1] * a
    values: _Array = low * (1 - b) + high * b
    return values
