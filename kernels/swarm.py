"""The particles under way, and how they are sorted by cell."""

import warp as wp

from flowtree.kernels.living_cells import LivingCells, cell_of

wp.set_module_options({"enable_backward": False})

NOBODY = wp.constant(1.0e30)  # a coordinate that no particle has


@wp.struct
class Swarm:
    """The particles under way: as the last step left them, sorted by cell, and what is written down of them.

    As the last step left them (n,):
        place, velocity: [m], [m] per unit of time.
        mass: particles combined.
        rate: 1 over the time in which it takes a new direction.
        number: of the particle.
        cell: -1 for who is under way no more.
        nearest: the nearest neighbour, as a place in the sorted list.
        moved: where its place in the sorted list has gone to in the next one; -1 for who has arrived, -2 - p
            for who joined the one at place p.
    Sorted (n,): velocities, masses, rates, before (the nearest as it was), host (whom it may join), taken (1
        where somebody joins it). The sorted places are those of the record, and x, y, z.
    Record (capacity,): points [m] and particle, step after step, sorted by cell; begin: where a step begins.
    By number (n,): joined, end_step.
    Cells: first (cells + 1,), where a cell begins in the sorted list; held (ranks, cells), particles counted
        by each thread.
    By thread (ranks,): counted; lowest and highest, corners of a box; heaviest, a mass.
    progress (4,): particles in the arrays above, steps taken, particles that have set off, 1 when all is
        done.
    arrived: see `wait_for_all`.
    """

    place: wp.array[wp.vec3]
    velocity: wp.array[wp.vec3]
    mass: wp.array[float]
    rate: wp.array[float]
    number: wp.array[int]
    cell: wp.array[int]
    nearest: wp.array[int]
    moved: wp.array[int]
    velocities: wp.array[wp.vec3]
    masses: wp.array[float]
    rates: wp.array[float]
    before: wp.array[int]
    host: wp.array[int]
    taken: wp.array[int]
    points: wp.array[wp.vec3]
    particle: wp.array[int]
    begin: wp.array[int]
    joined: wp.array[int]
    end_step: wp.array[int]
    first: wp.array[int]
    held: wp.array2d[int]
    counted: wp.array[int]
    lowest: wp.array[wp.vec3]
    highest: wp.array[wp.vec3]
    heaviest: wp.array[float]
    progress: wp.array[int]
    arrived: wp.array[int]


@wp.func
def set_off(
    swarm: Swarm,
    start: wp.array[wp.vec3],
    order: wp.array[int],
    was: int,
    now: int,
    rate: float,
    count: int,
):
    """Puts those that set off in this step behind the ``count`` particles under way."""
    k = int(was)
    while k < now:
        i = count + k - was
        swarm.place[i] = start[order[k]]
        swarm.velocity[i] = wp.vec3(0.0, 0.0, 0.0)
        swarm.mass[i] = 1.0
        swarm.rate[i] = rate
        swarm.number[i] = order[k]
        swarm.nearest[i] = -1
        swarm.cell[i] = 0
        k += 1


@wp.func
def count_in_cell(swarm: Swarm, cells: LivingCells, rank: int, i: int):
    """Notes the cell of particle i and counts it there."""
    cell = cell_of(cells, swarm.place[i])
    swarm.cell[i] = cell
    swarm.held[rank, cell] = swarm.held[rank, cell] + 1


@wp.func
def count_range(swarm: Swarm, low: int, high: int, ranks: int):
    """Particles in the cells from ``low`` to before ``high``."""
    total = int(0)
    for r in range(ranks):
        c = int(low)
        while c < high:
            total += swarm.held[r, c]
            c += 1
    return total


@wp.func
def number_range(swarm: Swarm, low: int, high: int, before: int, ranks: int):
    """Where each cell begins, and in it what each thread has counted; ``before`` lie in the cells before."""
    running = int(before)
    c = int(low)
    while c < high:
        swarm.first[c] = running
        for r in range(ranks):
            held = swarm.held[r, c]
            swarm.held[r, c] = running
            running += held
        c += 1


@wp.func
def sort_range(
    swarm: Swarm,
    rank: int,
    low: int,
    high: int,
    base: int,
    x_out: wp.array[float],
    y_out: wp.array[float],
    z_out: wp.array[float],
):
    """Puts the particles from ``low`` to before ``high`` where they belong; those of a cell keep their order.

    The sorted places are the record. On the way the thread notes the box and the greatest mass.
    """
    lowest = wp.vec3(NOBODY, NOBODY, NOBODY)
    highest = -lowest
    heaviest = float(1.0)
    i = int(low)
    while i < high:
        cell = swarm.cell[i]
        if cell >= 0:
            k = swarm.held[rank, cell]
            swarm.held[rank, cell] = k + 1
            at = swarm.place[i]
            swarm.points[base + k] = at
            x_out[k] = at[0]
            y_out[k] = at[1]
            z_out[k] = at[2]
            lowest = wp.min(lowest, at)
            highest = wp.max(highest, at)
            swarm.particle[base + k] = swarm.number[i]
            swarm.velocities[k] = swarm.velocity[i]
            mass = swarm.mass[i]
            swarm.masses[k] = mass
            heaviest = wp.max(heaviest, mass)
            swarm.rates[k] = swarm.rate[i]
            swarm.before[k] = swarm.nearest[i]
            swarm.taken[k] = 0
            swarm.moved[i] = k
        i += 1
    swarm.lowest[rank] = lowest
    swarm.highest[rank] = highest
    swarm.heaviest[rank] = heaviest
