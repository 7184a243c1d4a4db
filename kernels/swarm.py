"""The particles under way, and how they are sorted by cell."""

import warp as wp

from flowtree.kernels.living_cells import LivingCells, cell_of

wp.set_module_options({"enable_backward": False})

NOBODY = wp.constant(1.0e30)  # a coordinate that no particle has

# What is kept of each particle in one list of numbers, one after the other: all x, then all y and so on. So
# they are read and written sixteen at a time.
X = wp.constant(0)  # place [m]
Y = wp.constant(1)
Z = wp.constant(2)
U = wp.constant(3)  # velocity [m] per unit of time
V = wp.constant(4)
W = wp.constant(5)
MASS = wp.constant(6)  # particles combined
RATE = wp.constant(7)  # 1 over the time in which it takes a new direction
KINDS = wp.constant(8)


@wp.struct
class Swarm:
    """The particles under way: as the last step left them, sorted by cell, and what is written down of them.

    As the last step left them (n,):
        number: of the particle.
        cell: -1 for who is under way no more.
        nearest: the nearest neighbour, as a place in the sorted list.
        moved: where its place in the sorted list has gone to in the next one; -1 for who has arrived, -2 - p
            for who joined the one at place p.
    Sorted (n,): before (the nearest as it was), host (whom it may join), taken (1 where somebody joins it).
    Record (capacity,): points [m] and particle, step after step, sorted by cell; begin: where a step begins.
    By number (n,): joined, end_step.
    Cells: first (cells + 1,), where a cell begins in the sorted list; held (ranks, cells), particles counted
        by each thread.
    By thread (ranks,): counted; lowest and highest, corners of a box; heaviest, a mass.
    progress (5,): particles in the arrays above, steps taken, particles that have set off, 1 when all is
        done, particles that the cells were last fitted to; box (2,): corners of what they were fitted to.
    arrived: see `wait_for_all`.
    """

    number: wp.array[int]
    cell: wp.array[int]
    nearest: wp.array[int]
    moved: wp.array[int]
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
    box: wp.array[wp.vec3]
    arrived: wp.array[int]


@wp.func
def place_of(left: wp.array[float], size: int, i: int):
    """Where particle i of the list is [m]."""
    return wp.vec3(left[i], left[Y * size + i], left[Z * size + i])


@wp.func
def velocity_of(left: wp.array[float], size: int, i: int):
    """The velocity of particle i of the list [m] per unit of time."""
    return wp.vec3(left[U * size + i], left[V * size + i], left[W * size + i])


@wp.func
def set_off(
    swarm: Swarm,
    left: wp.array[float],
    size: int,
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
        at = start[order[k]]
        left[i] = at[0]
        left[Y * size + i] = at[1]
        left[Z * size + i] = at[2]
        left[U * size + i] = float(0.0)
        left[V * size + i] = float(0.0)
        left[W * size + i] = float(0.0)
        left[MASS * size + i] = float(1.0)
        left[RATE * size + i] = rate
        swarm.number[i] = order[k]
        swarm.nearest[i] = -1
        swarm.cell[i] = 0
        k += 1


@wp.func
def count_in_cell(swarm: Swarm, left: wp.array[float], size: int, cells: LivingCells, rank: int, i: int):
    """Notes the cell of particle i and counts it there."""
    cell = cell_of(cells, place_of(left, size, i))
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
    left: wp.array[float],
    listed: wp.array[float],
    size: int,
    rank: int,
    low: int,
    high: int,
    base: int,
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
            at = place_of(left, size, i)
            swarm.points[base + k] = at
            swarm.particle[base + k] = swarm.number[i]
            lowest = wp.min(lowest, at)
            highest = wp.max(highest, at)
            listed[k] = at[0]
            listed[Y * size + k] = at[1]
            listed[Z * size + k] = at[2]
            listed[U * size + k] = left[U * size + i]
            listed[V * size + k] = left[V * size + i]
            listed[W * size + k] = left[W * size + i]
            mass = left[MASS * size + i]
            listed[MASS * size + k] = mass
            heaviest = wp.max(heaviest, mass)
            listed[RATE * size + k] = left[RATE * size + i]
            swarm.before[k] = swarm.nearest[i]
            swarm.taken[k] = 0
            swarm.moved[i] = k
        i += 1
    swarm.lowest[rank] = lowest
    swarm.highest[rank] = highest
    swarm.heaviest[rank] = heaviest
