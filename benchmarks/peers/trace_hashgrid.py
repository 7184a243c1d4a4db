"""The workload in Warp as its documentation shows it: ``wp.HashGrid`` for the neighbours, plain launches."""

from __future__ import annotations

from typing import Any

import numpy as np
import warp as wp

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

wp.set_module_options({"enable_backward": False})

_GRID = 128  # cells along each side, after which they repeat

# Kernels know global numbers as Warp's constants only.
_STEP, _BASIN, _ARRIVAL = wp.constant(STEP), wp.constant(BASIN), wp.constant(ARRIVAL)
_RESPONSE, _INERTIA = wp.constant(RESPONSE), wp.constant(INERTIA)
_CELL, _LEFT, _LAST = wp.constant(CELL), wp.constant(LEFT), wp.constant(CELLS - 1)


@wp.func
def _view_vector(fields: wp.array3d[wp.vec2], view: int, right: float, up: float):
    """Bilinear value of one view's field."""
    u = wp.clamp((right - _LEFT) / _CELL - 0.5, 0.0, float(_LAST))
    v = wp.clamp(up / _CELL - 0.5, 0.0, float(_LAST))
    j = wp.min(int(u), _LAST - 1)
    i = wp.min(int(v), _LAST - 1)
    a = u - float(j)
    b = v - float(i)
    low = fields[view, i, j] * (1.0 - a) + fields[view, i, j + 1] * a
    high = fields[view, i + 1, j] * (1.0 - a) + fields[view, i + 1, j + 1] * a
    return low * (1.0 - b) + high * b


@wp.func
def _accelerate(
    fields: wp.array3d[wp.vec2],
    at: wp.vec3,
    v: wp.vec3,
    goal: wp.vec3,
    pulled: bool,
    radius: float,
    rate: float,
):
    front = _view_vector(fields, 0, at[0], at[1])
    side = _view_vector(fields, 1, -at[2], at[1])
    along = wp.normalize(wp.vec3(front[0], 0.5 * (front[1] + side[1]), -side[0]))
    free = wp.min(wp.length(at) / _BASIN, 1.0) * wp.clamp(1.0 + at[1] / _BASIN, 0.0, 1.0)
    wanted = along * free - wp.normalize(at) * (1.0 - free)
    gap = goal - at
    distance = wp.length(gap)
    if pulled and distance > 0.0 and distance < radius:
        wanted += gap * ((1.0 - distance / radius) / distance)
    return (wanted - v) * rate


@wp.kernel
def _find_nearest(
    grid: wp.uint64,
    x: wp.array[wp.vec3],
    radius: float,
    # out:
    nearest_out: wp.array[int],
    distance_out: wp.array[float],
):
    i = wp.tid()
    at = x[i]
    nearest = wp.int32(-1)
    best = radius
    for j in wp.hash_grid_query(grid, at, radius):
        if j != i:
            distance = wp.length(x[j] - at)
            if distance < best or (distance == best and nearest >= 0 and j < nearest):
                best = distance
                nearest = j
    nearest_out[i] = nearest
    distance_out[i] = best


@wp.kernel
def _join_and_advance(
    x: wp.array[wp.vec3],
    v: wp.array[wp.vec3],
    mass: wp.array[float],
    who: wp.array[int],
    nearest: wp.array[int],
    distance: wp.array[float],
    fields: wp.array3d[wp.vec2],
    radius: float,
    threshold: float,
    number: int,
    # out:
    x_out: wp.array[wp.vec3],
    v_out: wp.array[wp.vec3],
    mass_out: wp.array[float],
    lives_out: wp.array[int],
    joined_out: wp.array[int],
    end_step_out: wp.array[int],
    arrived_out: wp.array[int],
):
    i = wp.tid()
    x0 = x[i]
    v0 = v[i]
    m = mass[i]
    j = nearest[i]
    goal = x0
    pulled = j >= 0
    lives = wp.int32(1)
    if j >= 0:
        goal = x[j]
        if distance[i] < threshold and nearest[j] == i:
            pulled = False
            if m > mass[j] or (m == mass[j] and i < j):
                total = m + mass[j]
                x0 = (m * x0 + mass[j] * goal) / total
                v0 = (m * v0 + mass[j] * v[j]) / total
                m = total
            else:
                lives = 0
                joined_out[who[i]] = who[j]
                end_step_out[who[i]] = number
    rate = wp.min(1.0 / (_RESPONSE * wp.pow(m, _INERTIA)), 1.0 / _STEP)
    a1 = _accelerate(fields, x0, v0, goal, pulled, radius, rate)
    v2 = v0 + 0.5 * _STEP * a1
    a2 = _accelerate(fields, x0 + 0.5 * _STEP * v0, v2, goal, pulled, radius, rate)
    v3 = v0 + 0.5 * _STEP * a2
    a3 = _accelerate(fields, x0 + 0.5 * _STEP * v2, v3, goal, pulled, radius, rate)
    v4 = v0 + _STEP * a3
    a4 = _accelerate(fields, x0 + _STEP * v3, v4, goal, pulled, radius, rate)
    x0 += _STEP / 6.0 * (v0 + 2.0 * v2 + 2.0 * v3 + v4)
    v0 += _STEP / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4)
    if lives == 1 and wp.length(x0) < _ARRIVAL:
        lives = 0
        end_step_out[who[i]] = number
        arrived_out[who[i]] = 1
    x_out[i] = x0
    v_out[i] = v0
    mass_out[i] = m
    lives_out[i] = lives


@wp.kernel
def _keep_living(
    x: wp.array[wp.vec3],
    v: wp.array[wp.vec3],
    mass: wp.array[float],
    who: wp.array[int],
    lives: wp.array[int],
    place: wp.array[int],  # running sum of lives
    # out:
    x_out: wp.array[wp.vec3],
    v_out: wp.array[wp.vec3],
    mass_out: wp.array[float],
    who_out: wp.array[int],
):
    i = wp.tid()
    if lives[i] == 1:
        to = place[i] - 1
        x_out[to] = x[i]
        v_out[to] = v[i]
        mass_out[to] = mass[i]
        who_out[to] = who[i]


def trace_hashgrid(workload: Workload, *, device: str = "cpu") -> Traced:
    """Traces all particles; records are lists of places and of particles, a device array a step each."""
    count, where = len(workload.start), device
    if not count:
        return Traced(np.empty(0, np.int32), np.empty(0, np.int32), 0, 0, ([], []))
    radius, threshold = workload.radius, workload.threshold
    fields = wp.array(workload.vectors, dtype=wp.vec2, device=where)
    x, v, mass, who = _state(count, where)
    x_in, v_in, mass_in, who_in = _state(count, where)
    x.assign(workload.start)
    mass.fill_(1.0)
    who.assign(np.arange(count, dtype=np.int32))
    nearest, lives, place = (wp.empty(count, dtype=int, device=where) for _ in range(3))
    distance = wp.empty(count, dtype=float, device=where)
    joined, end_step = (wp.full(count, -1, dtype=int, device=where) for _ in range(2))
    arrived = wp.zeros(count, dtype=int, device=where)
    grid = wp.HashGrid(_GRID, _GRID, _GRID, device=where)
    places, particles, living, number = [], [], count, 0
    while living and number < MOST_STEPS:
        now = [array[:living] for array in (x, v, mass, who)]
        places.append(wp.clone(now[0]))
        particles.append(wp.clone(now[3]))
        grid.build(now[0], radius)  # with smaller cells a query takes longer
        wp.launch(_find_nearest, living, [grid.id, now[0], radius], [nearest, distance], device=where)
        wp.launch(
            _join_and_advance,
            living,
            [*now, nearest, distance, fields, radius, threshold, number],
            [x_in, v_in, mass_in, lives, joined, end_step, arrived],
            device=where,
        )
        wp.utils.array_scan(lives[:living], place[:living], inclusive=True)
        inputs = [x_in, v_in, mass_in, who, lives, place]
        wp.launch(_keep_living, living, inputs, [x, v, mass, who_in], device=where)
        who, who_in = who_in, who
        living = int(place[living - 1 : living].numpy()[0])
        number += 1
    steps = sum(len(step) for step in particles)
    return Traced(joined.numpy(), end_step.numpy(), int(arrived.numpy().sum()), steps, (places, particles))


def _state(count: int, where: str) -> list[Any]:
    """Place, velocity, mass and particle."""
    return [wp.zeros(count, dtype=kind, device=where) for kind in (wp.vec3, wp.vec3, float, int)]
