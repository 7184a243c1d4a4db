"""Who goes over to whom, and what becomes of those that take others in (section 6)."""

import warp as wp

from flowtree.kernels.advance_particles import FlowForces
from flowtree.kernels.living_cells import LivingCells, cells_around
from flowtree.kernels.swarm import (
    END_STEP,
    HOST,
    JOINED,
    MASS,
    MOVED,
    NEAREST,
    TAKEN,
    Swarm,
    Y,
    Z,
    place_of,
    velocity_of,
)

wp.set_module_options({"enable_backward": False})


@wp.struct
class Meeting:
    """A particle after it has met others: where it goes on from, or that it does not."""

    place: wp.vec3
    velocity: wp.vec3
    mass: float
    alive: int
    grown: int


@wp.func
def find_host(
    swarm: Swarm,
    particle: wp.array[int],
    cells: LivingCells,
    forces: FlowForces,
    listed: wp.array[float],
    size: int,
    base: int,
    heaviest: float,
    i: int,
):
    """The heavier particle (of equals the one of lower number) whose threshold i has gone past farthest."""
    mass = listed[MASS * size + i]
    number = particle[base + i]
    far = 1.00001 * wp.min(
        forces.reach + forces.growth * (wp.sqrt(mass + heaviest) - 1.0),
        wp.max(forces.attraction_radius, forces.reach),
    )
    around = cells_around(cells, place_of(listed, size, i), far)
    row_z = int(around.back)
    host = int(-1)
    deepest = float(1.0)
    while row_z <= around.front:
        row_y = int(around.low)
        while row_y <= around.high:
            row = cells.nx * (row_y + cells.ny * row_z)
            k = swarm.first[row + around.left]
            stop = swarm.first[row + around.right + 1]
            while k < stop:
                dx = listed[k] - listed[i]
                dy = listed[Y * size + k] - listed[Y * size + i]
                dz = listed[Z * size + k] - listed[Z * size + i]
                square = dx * dx + dy * dy + dz * dz
                if square <= far * far and k != i:
                    other = listed[MASS * size + k]
                    if other > mass or (other == mass and particle[base + k] < number):
                        threshold = forces.reach + forces.growth * (wp.sqrt(mass + other) - 1.0)
                        threshold = wp.min(threshold, wp.max(forces.attraction_radius, forces.reach))
                        depth = square / (threshold * threshold)
                        if depth < deepest or (
                            depth == deepest and (host < 0 or particle[base + k] < particle[base + host])
                        ):
                            deepest = depth
                            host = k
                k += 1
            row_y += 1
        row_z += 1
    return host


@wp.func
def unmet(listed: wp.array[float], size: int, i: int):
    """Particle i as it is before it meets anybody."""
    met = Meeting()
    met.place = place_of(listed, size, i)
    met.velocity = velocity_of(listed, size, i)
    met.mass = listed[MASS * size + i]
    met.alive = 1
    met.grown = 0
    return met


@wp.func
def meet_pair(
    notes: wp.array[int],
    particle: wp.array[int],
    listed: wp.array[float],
    size: int,
    base: int,
    number: int,
    i: int,
):
    """The paper's rule: two that are each other's nearest, and nearer than the threshold, become one."""
    met = unmet(listed, size, i)
    j = notes[NEAREST * size + i]
    me = particle[base + i]
    other = listed[MASS * size + j]
    if other > met.mass or (other == met.mass and particle[base + j] < me):
        met.alive = 0
        notes[MOVED * size + i] = -2 - j
        notes[JOINED * size + me] = particle[base + j]
        notes[END_STEP * size + me] = number
    else:
        total = met.mass + other
        met.place = (met.place * met.mass + place_of(listed, size, j) * other) / total
        met.velocity = (met.velocity * met.mass + velocity_of(listed, size, j) * other) / total
        met.mass = total
        met.grown = 1
    return met


@wp.func
def meet_limb(
    swarm: Swarm,
    notes: wp.array[int],
    particle: wp.array[int],
    cells: LivingCells,
    forces: FlowForces,
    listed: wp.array[float],
    size: int,
    base: int,
    number: int,
    i: int,
):
    """A limb takes in at once all that have it for their host, unless it goes over to another itself."""
    met = unmet(listed, size, i)
    met.grown = notes[TAKEN * size + i]
    host = notes[HOST * size + i]
    if host >= 0:
        if notes[HOST * size + host] < 0:
            me = particle[base + i]
            met.alive = 0
            notes[MOVED * size + i] = -2 - host
            notes[JOINED * size + me] = particle[base + host]
            notes[END_STEP * size + me] = number
    if met.grown == 1:
        # No guest is heavier than its host, so none is farther away than this.
        far = 1.00001 * (forces.reach + forces.growth * (wp.sqrt(2.0 * met.mass) - 1.0))
        total = met.mass
        moment = met.mass * met.place
        momentum = met.mass * met.velocity
        around = cells_around(cells, place_of(listed, size, i), far)
        row_z = int(around.back)
        while row_z <= around.front:
            row_y = int(around.low)
            while row_y <= around.high:
                row = cells.nx * (row_y + cells.ny * row_z)
                k = swarm.first[row + around.left]
                stop = swarm.first[row + around.right + 1]
                while k < stop:
                    if notes[HOST * size + k] == i:
                        other = listed[MASS * size + k]
                        total += other
                        moment += other * place_of(listed, size, k)
                        momentum += other * velocity_of(listed, size, k)
                    k += 1
                row_y += 1
            row_z += 1
        met.place = moment / total
        met.velocity = momentum / total
        met.mass = total
    return met
