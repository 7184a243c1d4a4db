"""The peers compute the workload, and the same: they equal a slow and obvious program in double precision."""

from __future__ import annotations

import dataclasses
from functools import lru_cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks.peers.trace_numba import trace_numba
from benchmarks.programs import PROGRAMS
from benchmarks.validate_traced import EARLY, compare_traced, find_faults
from benchmarks.workload import ARRIVAL, BASIN, INERTIA, MOST_STEPS, RESPONSE, STEP, Traced, make_workload


def _look_up(field, u, v):
    """Bilinear in one view's field, of cells 0.01 wide from (-0.5, 0) on; [x, y] of the view."""
    column, row = np.clip((u + 0.5) * 100 - 0.5, 0, 99), np.clip(v * 100 - 0.5, 0, 99)
    j, i = min(int(column), 98), min(int(row), 98)
    a, b = column - j, row - i
    low = (1 - a) * field[i, j] + a * field[i, j + 1]
    return (1 - b) * low + b * ((1 - a) * field[i + 1, j] + a * field[i + 1, j + 1])


def _acceleration(workload, at, velocity, goal, mass):
    front = _look_up(workload.vectors[0].astype(float), at[0], at[1])
    side = _look_up(workload.vectors[1].astype(float), -at[2], at[1])
    total = np.array([front[0], front[1] + side[1], -side[0]]) * (1, 0.5, 1)
    far = np.linalg.norm(at)
    free = min(far / BASIN, 1) * np.clip(1 + at[1] / BASIN, 0, 1)
    wanted = total / np.linalg.norm(total) * free - at / far * (1 - free)
    if goal is not None:
        distance = np.linalg.norm(goal - at)
        if 0 < distance < workload.radius:
            wanted += (goal - at) / distance * (1 - distance / workload.radius)
    return (wanted - velocity) * min(1 / (RESPONSE * mass**INERTIA), 1 / STEP)


def _advance(workload, x, v, goal, mass):
    def slope(x, v):
        return v, _acceleration(workload, x, v, goal, mass)

    k1 = slope(x, v)
    k2 = slope(x + STEP / 2 * k1[0], v + STEP / 2 * k1[1])
    k3 = slope(x + STEP / 2 * k2[0], v + STEP / 2 * k2[1])
    k4 = slope(x + STEP * k3[0], v + STEP * k3[1])
    return tuple(
        y + STEP / 6 * (a + 2 * b + 2 * c + d) for y, a, b, c, d in zip((x, v), k1, k2, k3, k4, strict=True)
    )


def _nearest(workload, x, i, living):
    far = np.linalg.norm(np.array([x[j] for j in living]) - x[i], axis=1)
    far[living.index(i)] = np.inf
    best = int(far.argmin())  # the first of equal ones: the lowest particle
    return (living[best], far[best]) if far[best] < workload.radius else (-1, np.inf)


def _trace(workload, most=MOST_STEPS) -> Traced:
    count = len(workload.start)
    joined, end = np.full(count, -1, np.int32), np.full(count, -1, np.int32)
    x, v = [place.astype(float) for place in workload.start], [np.zeros(3) for _ in range(count)]
    mass, living, steps = [1] * count, list(range(count)), 0
    for number in range(most):
        steps += len(living)
        near = {i: _nearest(workload, x, i, living) for i in living}
        before, alone = list(x), set()
        for i in living:
            j, far = near[i]
            if j < 0 or near[j][0] != i or far >= workload.threshold or (-mass[i], i) > (-mass[j], j):
                continue
            total = mass[i] + mass[j]
            for state in (x, v):
                state[i] = (mass[i] * state[i] + mass[j] * state[j]) / total
            mass[i], joined[j], end[j] = total, i, number
            alone.add(i)
        for i in [i for i in living if end[i] < 0]:
            goal = before[near[i][0]] if near[i][0] >= 0 and i not in alone else None
            x[i], v[i] = _advance(workload, x[i], v[i], goal, mass[i])
            if np.linalg.norm(x[i]) < ARRIVAL:
                end[i] = number
        living = [i for i in living if end[i] < 0]
    return Traced(joined, end, int((joined < 0).sum()), steps, None)


@lru_cache
def _known(count):
    workload = make_workload(count, seed=3)
    return workload, _trace(workload)


@pytest.mark.parametrize("count", [0, 1, 2, 50, 500])
@pytest.mark.parametrize("name", PROGRAMS)
def test_equals_the_obvious_program(name, count):
    workload, known = _known(count)
    traced = PROGRAMS[name](workload)
    assert find_faults(traced, count) == []
    assert (traced.joined.dtype, traced.end_step.dtype) == (np.int32, np.int32)
    early = known.end_step < EARLY
    assert (traced.joined[early] == known.joined[early]).all(), "before rounding has added up"
    agreement = compare_traced(traced, known)
    assert agreement.holds, agreement


def _count_recorded(name, records):
    if name == "numba":
        (x, y, z, who), lengths = records
        assert len(x) == len(y) == len(z) == lengths.sum()
        return np.bincount(who)
    if name.startswith("flowtree"):
        assert len(records.points) == records.particle_steps
        return np.bincount(records.particle)
    places, particles = records
    assert [len(step) for step in places] == [len(step) for step in particles]
    if name.startswith("hashgrid"):
        particles = [step.numpy() for step in particles]
    return np.bincount(np.concatenate(particles))


@pytest.mark.parametrize("name", PROGRAMS)
def test_everybody_is_recorded_until_it_ends(name):
    workload, _ = _known(500)
    before = workload.start.copy()
    traced = PROGRAMS[name](workload)
    assert (_count_recorded(name, traced.records) == traced.end_step + 1).all()
    assert (workload.start == before).all(), "the next program starts from it"


def test_flowtree_writes_the_same_bytes_on_one_core():
    workload = make_workload(3000)
    one, all_of_them = PROGRAMS["flowtree-1"](workload), PROGRAMS["flowtree"](workload)
    assert one.records.points.tobytes() == all_of_them.records.points.tobytes()
    assert one.records.particle.tobytes() == all_of_them.records.particle.tobytes()
    assert one.joined.tobytes() == all_of_them.joined.tobytes()


def test_numba_traces_the_same_on_one_core_and_twice_the_same_bytes():
    workload = make_workload(3000)
    one, two, again = trace_numba(workload, threads=1), trace_numba(workload), trace_numba(workload)
    assert compare_traced(one, two).holds  # ends of blocks are rounded otherwise than vectors
    for a, b in zip(two.records[0], again.records[0], strict=True):
        assert a.tobytes() == b.tobytes()


@settings(deadline=None, max_examples=15)
@given(
    seed=st.integers(0, 2**32 - 1), shape=st.sampled_from(["clustered", "collinear", "coincident", "outside"])
)
def test_odd_starts_are_traced_without_faults(seed, shape):
    random = np.random.default_rng(seed)
    workload = make_workload(60, seed=1)
    start = {
        "clustered": workload.start[:1] + random.normal(0, 0.01, (60, 3)),
        "collinear": workload.start[:1] + np.outer(random.random(60), (0.1, 0.2, 0.0)),
        "coincident": np.repeat(workload.start[:6], 10, axis=0),
        "outside": workload.start + np.array([2.0, 1.0, -3.0]),
    }[shape]
    odd = dataclasses.replace(workload, start=start.astype(np.float32))
    traced = trace_numba(odd)
    assert find_faults(traced, 60) == []
    assert np.where(traced.end_step < 2, traced.joined, -1).tolist() == _trace(odd, 2).joined.tolist()
