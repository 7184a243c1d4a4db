"""The float64 twin of `flowtree.kernels.advance_particles`: one particle after the other."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from flowtree.kernels.reference.flow_fields import flow_direction, sample_box


def free_flow_time(times: Any, at: NDArray[Any]) -> float:
    """Trilinear value; points outside take the value at the border."""
    return float(sample_box(times.time, times.corner, times.spacing, at))


def acceleration(
    fields: Any,
    forces: Any,
    at: NDArray[Any],
    velocity: NDArray[Any],
    neighbour: NDArray[Any],
    attraction: float,
    speed: float,
    rate: float,
) -> NDArray[Any]:
    """Force over mass: what turns the velocity into the wanted one."""
    wanted = flow_direction(fields, at)
    gap = neighbour - at
    distance = float(np.linalg.norm(gap))
    if 0.0 < distance < forces.attraction_radius:
        fade = 1.0 - distance / forces.attraction_radius
        wanted = wanted + gap / distance * attraction * fade
    return np.asarray((wanted * speed - velocity) * rate)


def move(
    fields: Any,
    forces: Any,
    place: NDArray[Any],
    velocity: NDArray[Any],
    mass: float,
    neighbour: NDArray[Any] | None,
    speed: float,
    step: float,
) -> tuple[NDArray[Any], NDArray[Any]]:
    """Place and velocity after one step of the classical Runge-Kutta method."""
    rate = min(1.0 / (forces.response * mass**forces.inertia), 1.0 / step)
    attraction = 0.0 if neighbour is None else float(forces.attraction)
    there = place if neighbour is None else neighbour

    def change(y: NDArray[Any]) -> NDArray[Any]:
        pull = acceleration(fields, forces, y[:3], y[3:], there, attraction, speed, rate)
        return np.concatenate([y[3:], pull])

    y = np.concatenate([place, velocity])
    k1 = change(y)
    k2 = change(y + 0.5 * step * k1)
    k3 = change(y + 0.5 * step * k2)
    k4 = change(y + step * k3)
    y = y + step / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
    return y[:3], y[3:]


def advance_particles(
    first: int,
    position: NDArray[Any],
    place: NDArray[Any],
    velocity: NDArray[Any],
    mass: NDArray[Any],
    state: NDArray[Any],
    nearest: NDArray[Any],
    begin: NDArray[Any],
    fields: Any,
    forces: Any,
    times: Any,
    front: float,
    step: float,
    arrival: float,
    number: int,
    position_out: NDArray[Any],
    velocity_out: NDArray[Any],
    state_out: NDArray[Any],
    end_step_out: NDArray[Any],
) -> None:
    """Moves every particle by one step of the classical Runge-Kutta method; then some set off."""
    for i in range(first, len(mass)):
        x, v = np.asarray(position[i], np.float64), np.asarray(velocity[i], np.float64)
        now = state[i]
        if now == 1:
            neighbour = np.asarray(place[nearest[i]], np.float64) if nearest[i] >= 0 else None
            speed = float(np.clip(1.0 + forces.pace * (free_flow_time(times, x) - front), 0.4, 2.0))
            x, v = move(fields, forces, x, v, float(mass[i]), neighbour, speed, step)
            if np.linalg.norm(x) < arrival:
                now, end_step_out[i] = 3, number
        elif now == 0 and begin[i] == number + 1:
            now = 1
        position_out[i], velocity_out[i], state_out[i] = x, v, now
