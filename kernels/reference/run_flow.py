"""The float64 twin of `flowtree.kernels.run_flow`: everybody against everybody, one step after the other."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from flowtree.kernels.reference.advance_particles import free_flow_time, move


def threshold(forces: Any, mass: float, other: float) -> float:
    """Two of these masses that are nearer than this may join [m]."""
    if forces.limbs == 0:
        return float(forces.reach)
    grown = forces.reach + forces.growth * (np.sqrt(mass + other) - 1.0)
    return float(min(grown, max(forces.attraction_radius, forces.reach)))


def find_nearest(place: dict[int, NDArray[Any]], radius: float) -> dict[int, int]:
    """The nearest within the radius of each particle that has one; of equally near ones the lowest number."""
    nearest = {}
    for i in place:
        near = [(float(np.linalg.norm(place[j] - place[i])), j) for j in place if j != i]
        near = [(gap, j) for gap, j in near if gap < radius]
        if near:
            nearest[i] = min(near)[1]
    return nearest


def find_hosts(
    place: dict[int, NDArray[Any]], mass: dict[int, float], nearest: dict[int, int], forces: Any
) -> dict[int, int]:
    """Whom each particle goes over to: always one that is heavier, or as heavy and of lower number."""
    hosts = {}
    for i in place:
        if forces.limbs == 0:
            others = [nearest[i]] if nearest.get(nearest.get(i, -1)) == i else []
        else:
            others = [j for j in place if j != i]
        depths = []
        for j in others:
            depth = float(np.linalg.norm(place[j] - place[i])) / threshold(forces, mass[i], mass[j])
            if depth < 1.0 and (mass[j], -j) > (mass[i], -i):
                depths.append((depth, j))
        if depths:
            hosts[i] = min(depths)[1]
    # Who is to go over to one that goes over to another itself, goes on alone.
    return {i: host for i, host in hosts.items() if host not in hosts}


def run_flow(
    first: int,
    ranks: int,
    steps: int,
    capacity: int,
    start: NDArray[Any],
    order: NDArray[Any],
    off: NDArray[Any],
    fields: Any,
    forces: Any,
    times: Any,
    latest: float,
    step: float,
    arrival: float,
    left_out: NDArray[Any] | None,
    listed_out: NDArray[Any] | None,
    notes_out: NDArray[Any] | None,
    points_out: NDArray[Any],
    particle_out: NDArray[Any],
    swarm_out: Any,
) -> None:
    """Steps from the start until nobody is under way, and keeps every step, by number within each.

    The threads, the capacity (the record must hold all), the lists and where ``swarm_out`` stands are
    ignored. Besides the record, ``swarm_out`` gets begin, progress, and what the kernel writes to its notes:
    joined and end_step. The search reaches as far as two may join, even if that is farther than they draw.
    """
    del first, ranks, capacity, left_out, listed_out, notes_out
    place: dict[int, NDArray[Any]] = {}
    velocity: dict[int, NDArray[Any]] = {}
    mass: dict[int, float] = {}
    gone = number = base = count = done = 0
    radius = max(forces.attraction_radius, forces.reach)
    while number < steps and not done:
        for i in order[gone : off[number]].tolist():
            place[i], velocity[i], mass[i] = np.asarray(start[i], np.float64), np.zeros(3), 1.0
        gone, count = int(off[number]), len(place)
        for i in place:
            points_out[base], particle_out[base] = place[i], i
            base += 1
        before = dict(place)  # neighbours are taken as they were at the beginning of the step
        nearest = find_nearest(place, radius)
        hosts = find_hosts(place, mass, nearest, forces)
        for host in set(hosts.values()):
            both = [host, *(i for i in hosts if hosts[i] == host)]
            total = sum(mass[i] for i in both)
            place[host] = sum(mass[i] * before[i] for i in both) / total
            velocity[host] = sum(mass[i] * velocity[i] for i in both) / total
            mass[host] = total
            if forces.limbs == 0:
                nearest.pop(host)  # it has just taken that one in
        for i, host in hosts.items():
            swarm_out.joined[i], swarm_out.end_step[i] = host, number
            del place[i]
        front = latest - number * step
        for i in list(place):
            speed = 1.0
            if forces.pace > 0.0:
                late = free_flow_time(times, place[i]) - front
                speed = float(np.clip(1.0 + forces.pace * late, 0.4, 2.0))
            neighbour = before[nearest[i]] if i in nearest else None
            place[i], velocity[i] = move(
                fields, forces, place[i], velocity[i], mass[i], neighbour, speed, step
            )
            if np.linalg.norm(place[i]) < arrival:
                swarm_out.end_step[i] = number
                del place[i]
        number += 1
        swarm_out.begin[number] = base
        new, waiting = int(off[number]) - gone, int(off[steps]) > int(off[number])
        done = int(count == 0 and new == 0 and not waiting)
        count += new
    swarm_out.progress[:4] = [count, number, int(off[number]), done]
