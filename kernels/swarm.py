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


# What is known of each particle in whole numbers, likewise one after the other.
# As the last step left them:
NUMBER = wp.constant(0)  # of the particle
CELL = wp.constant(1)  # -1 for who is under way no more
NEAREST = wp.constant(2)  # the nearest neighbour, as a place in the sorted list
# Where its place in the sorted list has gone to in the next one; -1 for who has arrived, -2 - p for who
# joined the one at place p.
MOVED = wp.constant(3)
# Sorted by cell:
BEFORE = wp.constant(4)  # the nearest as it was, as a place in the last step's list
HOST = wp.constant(5)  # whom it may join
TAKEN = wp.constant(6)  # 1 where somebody joins it
# By number:
JOINED = wp.constant(7)  # whom it joined; -1 for nobody
END_STEP = wp.constant(8)  # the last step that it is recorded in; -1 while it is under way
NOTES = wp.constant(9)

# What the threads tell each other in whole numbers, and from launch to launch.
COUNT = wp.constant(0)  # particles in the lists
NUMBER_OF_STEPS = wp.constant(1)
GONE = wp.constant(2)  # particles that have set off
DONE = wp.constant(3)  # 1 when nobody is under way any more
FITTED = wp.constant(4)  # particles that the cells were last fitted to
COUNTED = wp.constant(5)  # and on: how many each thread has in its cells
# And of lengths: seven a thread, and six for what the cells were last fitted to.
LOWEST = wp.constant(0)  # corner of a box, and the next two
HIGHEST = wp.constant(3)
HEAVIEST = wp.constant(6)  # a mass
SPAN = wp.constant(7)


@wp.struct
class Swarm:
    """What all threads of a flow share: its cells, where the record's steps begin, and what they tell.

    first: (cells + 1,), where a cell begins in the sorted list.
    held: (ranks, cells), particles counted by each thread.
    begin: (steps + 1,), where a step begins in the record.
    tally: (COUNTED + ranks,) see there.
    span: ((ranks + 1) * SPAN,) a row a thread, the last for the box of the cells.
    arrived: see `wait_for_all`.
    """

    first: wp.array[int]
    held: wp.array2d[int]
    begin: wp.array[int]
    tally: wp.array[int]
    span: wp.array[float]
    arrived: wp.array[int]


@wp.func
def lowest_of(swarm: Swarm, rank: int):
    """The lower corner of what a thread has seen [m]."""
    k = SPAN * rank + LOWEST
    return wp.vec3(swarm.span[k], swarm.span[k + 1], swarm.span[k + 2])


@wp.func
def highest_of(swarm: Swarm, rank: int):
    """The upper corner of what a thread has seen [m]."""
    k = SPAN * rank + HIGHEST
    return wp.vec3(swarm.span[k], swarm.span[k + 1], swarm.span[k + 2])


@wp.func
def tell_box(swarm: Swarm, rank: int, lowest: wp.vec3, highest: wp.vec3):
    """Writes down the corners of what a thread has seen [m]."""
    for axis in range(3):
        swarm.span[SPAN * rank + LOWEST + axis] = lowest[axis]
        swarm.span[SPAN * rank + HIGHEST + axis] = highest[axis]


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
    notes: wp.array[int],
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
        notes[i] = order[k]
        notes[NEAREST * size + i] = -1
        notes[CELL * size + i] = 0
        k += 1


@wp.func
def count_in_cell(
    swarm: Swarm,
    notes: wp.array[int],
    left: wp.array[float],
    size: int,
    cells: LivingCells,
    rank: int,
    i: int,
):
    """Notes the cell of particle i and counts it there."""
    cell = cell_of(cells, place_of(left, size, i))
    notes[CELL * size + i] = cell
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
    notes: wp.array[int],
    points: wp.array[wp.vec3],
    particle: wp.array[int],
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
        cell = notes[CELL * size + i]
        if cell >= 0:
            k = swarm.held[rank, cell]
            swarm.held[rank, cell] = k + 1
            at = place_of(left, size, i)
            points[base + k] = at
            particle[base + k] = notes[i]
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
            notes[BEFORE * size + k] = notes[NEAREST * size + i]
            notes[TAKEN * size + k] = 0
            notes[MOVED * size + i] = k
        i += 1
    tell_box(swarm, rank, lowest, highest)
    swarm.span[SPAN * rank + HEAVIEST] = heaviest
