"""The nearest neighbours of a block of particles, found together (section 6)."""

import warp as wp

from flowtree.kernels.living_cells import LivingCells, cells_around
from flowtree.kernels.swarm import BEFORE, MOVED, NEAREST, Y, Z

# Loops over the lanes of a block must stay loops: the compiler makes vector instructions of sixteen rounds.
wp.set_module_options({"enable_backward": False, "max_unroll": 8})

BLOCK = wp.constant(64)  # particles whose neighbours are looked for together
LANES = wp.constant(16)  # places compared at once
# Warp takes a negative index from the end: told that there is none, the compiler loads sixteen at once.
NOT_NEGATIVE = wp.constant(0x7FFFFFFF)
Floats = wp.types.vector(length=64, dtype=float)
Wholes = wp.types.vector(length=64, dtype=int)
FourFloats = wp.types.vector(length=256, dtype=float)  # four of each
FourWholes = wp.types.vector(length=256, dtype=int)


@wp.func
def square_between(listed: wp.array[float], size: int, i: int, j: int):
    """Squared distance of two particles of the list."""
    dx = listed[j] - listed[i]
    dy = listed[Y * size + j] - listed[Y * size + i]
    dz = listed[Z * size + j] - listed[Z * size + i]
    return dx * dx + dy * dy + dz * dz


@wp.func
def guess_nearest(
    listed: wp.array[float],
    size: int,
    count: int,
    notes: wp.array[int],
    i: int,
):
    """Somebody near, to bound the search: the nearest of the last step, else one beside in the list."""
    near = notes[BEFORE * size + i]
    if near >= 0:
        near = notes[MOVED * size + near]
        if near < -1:
            near = notes[MOVED * size - 2 - near]
    if near < 0 or near == i:
        near = wp.where(i > 0, i - 1, i + 1)
        if i > 0 and i + 1 < count:
            if square_between(listed, size, i, i + 1) < square_between(listed, size, i, i - 1):
                near = i + 1
        if count < 2:
            near = -1
    return near


@wp.func
def search_cells(
    grid: LivingCells,
    begin: wp.array[int],
    listed: wp.array[float],
    size: int,
    i: int,
    near: int,
    square: float,
):
    """Who is nearer to particle i than ``near`` at the squared distance; of equals the first found."""
    reach = wp.sqrt(square) * 1.00001  # a rounding error must not leave out a cell
    at = wp.vec3(listed[i], listed[Y * size + i], listed[Z * size + i])
    around = cells_around(grid, at, reach)
    row_z = int(around.back)
    while row_z <= around.front:
        row_y = int(around.low)
        while row_y <= around.high:
            row = grid.nx * (row_y + grid.ny * row_z)
            k = begin[row + around.left]
            stop = begin[row + around.right + 1]
            while k < stop and square > 0.0:
                distance = square_between(listed, size, i, k)
                if distance < square and k != i:
                    square = distance
                    near = k
                k += 1
            row_y += 1
        row_z += 1
    return near


@wp.func
def find_nearest_in_block(
    grid: LivingCells,
    begin: wp.array[int],
    listed: wp.array[float],
    size: int,
    count: int,
    radius: float,
    first: int,
    last: int,
    notes_out: wp.array[int],
):
    """The nearest within the radius, as a place in the sorted list or -1, from ``first`` to before ``last``.

    Exact: a particle's nearest of the last step bounds the search, wherever that one is now, so the reach
    follows the local density. Step by step for at most `BLOCK` particles at once, so that no step has to
    guess how another one branches: the bounds; how many are nearer than them in the first sixteen places of
    the four rows of cells that a ball touches (most hold none; places beyond a row's end are compared for
    nothing); the few rows that hold one; and the few balls that touch more, one cell after the other.
    """
    px = Floats()
    py = Floats()
    pz = Floats()
    best = Floats()
    near = Wholes()
    left = Wholes()
    right = Wholes()
    low = Wholes()
    high = Wholes()
    back = Wholes()
    front = Wholes()
    slow = Wholes()
    hit_lane = FourWholes()
    hit_k = FourWholes()
    n = last - first
    lane = int(0)
    while lane < n:
        i = first + lane
        px[lane] = listed[i]
        py[lane] = listed[Y * size + i]
        pz[lane] = listed[Z * size + i]
        guess = guess_nearest(listed, size, count, notes_out, i)
        square = radius * radius
        if guess >= 0:
            distance = square_between(listed, size, i, guess)
            guess = wp.where(distance < square, guess, -1)
            square = wp.min(distance, square)
        near[lane] = guess
        best[lane] = square
        lane += 1
    corner = grid.corner
    per = grid.per_metre
    last_x = float(grid.nx - 1)
    last_y = float(grid.ny - 1)
    last_z = float(grid.nz - 1)
    for q in range(BLOCK):
        reach = wp.sqrt(best[q]) * 1.00001
        left[q] = int(wp.min(wp.max((px[q] - reach - corner[0]) * per[0], 0.0), last_x))
        right[q] = int(wp.min(wp.max((px[q] + reach - corner[0]) * per[0], 0.0), last_x))
        low[q] = int(wp.min(wp.max((py[q] - reach - corner[1]) * per[1], 0.0), last_y))
        high[q] = int(wp.min(wp.max((py[q] + reach - corner[1]) * per[1], 0.0), last_y))
        back[q] = int(wp.min(wp.max((pz[q] - reach - corner[2]) * per[2], 0.0), last_z))
        front[q] = int(wp.min(wp.max((pz[q] + reach - corner[2]) * per[2], 0.0), last_z))
    slows = int(0)
    hits = int(0)
    row_y = (Y * size) & NOT_NEGATIVE
    row_z = (Z * size) & NOT_NEGATIVE
    lane = int(0)
    while lane < n:
        tall = high[lane] - low[lane]
        deep = front[lane] - back[lane]
        row = grid.nx * (low[lane] + grid.ny * back[lane])
        row_up = row + wp.where(tall > 0, grid.nx, 0)
        behind = wp.where(deep > 0, grid.nx * grid.ny, 0)
        begins = left[lane]
        ends = right[lane] + 1
        k0 = begin[(row + begins) & NOT_NEGATIVE] & NOT_NEGATIVE
        k1 = begin[(row_up + begins) & NOT_NEGATIVE] & NOT_NEGATIVE
        k2 = begin[(row + behind + begins) & NOT_NEGATIVE] & NOT_NEGATIVE
        k3 = begin[(row_up + behind + begins) & NOT_NEGATIVE] & NOT_NEGATIVE
        e0 = begin[(row + ends) & NOT_NEGATIVE] - LANES
        e1 = begin[(row_up + ends) & NOT_NEGATIVE] - LANES
        e2 = begin[(row + behind + ends) & NOT_NEGATIVE] - LANES
        e3 = begin[(row_up + behind + ends) & NOT_NEGATIVE] - LANES
        ax = px[lane]
        ay = py[lane]
        az = pz[lane]
        limit = best[lane]
        nearer = int(0)
        for s in range(LANES):
            x0 = listed[k0 + s] - ax
            y0 = listed[row_y + k0 + s] - ay
            z0 = listed[row_z + k0 + s] - az
            x1 = listed[k1 + s] - ax
            y1 = listed[row_y + k1 + s] - ay
            z1 = listed[row_z + k1 + s] - az
            x2 = listed[k2 + s] - ax
            y2 = listed[row_y + k2 + s] - ay
            z2 = listed[row_z + k2 + s] - az
            x3 = listed[k3 + s] - ax
            y3 = listed[row_y + k3 + s] - ay
            z3 = listed[row_z + k3 + s] - az
            # A count for each row, eight bits apart.
            nearer += (
                wp.where(x0 * x0 + y0 * y0 + z0 * z0 < limit, 1, 0)
                + wp.where(x1 * x1 + y1 * y1 + z1 * z1 < limit, 256, 0)
                + wp.where(x2 * x2 + y2 * y2 + z2 * z2 < limit, 65536, 0)
                + wp.where(x3 * x3 + y3 * y3 + z3 * z3 < limit, 16777216, 0)
            )
        i = first + lane
        # Everybody is nearest to himself.
        nearer -= (
            wp.where(i >= k0 and i < k0 + LANES, 1, 0)
            + wp.where(i >= k1 and i < k1 + LANES, 256, 0)
            + wp.where(i >= k2 and i < k2 + LANES, 65536, 0)
            + wp.where(i >= k3 and i < k3 + LANES, 16777216, 0)
        )
        if nearer != 0:
            hit_k[hits] = k0
            hit_lane[hits] = lane
            hits += wp.where((nearer & 255) != 0, 1, 0)
            hit_k[hits] = k1
            hit_lane[hits] = lane
            hits += wp.where((nearer & 65280) != 0 and tall > 0, 1, 0)
            hit_k[hits] = k2
            hit_lane[hits] = lane
            hits += wp.where((nearer & 16711680) != 0 and deep > 0, 1, 0)
            hit_k[hits] = k3
            hit_lane[hits] = lane
            hits += wp.where(nearer >= 16777216 and tall > 0 and deep > 0, 1, 0)
        slow[slows] = lane
        if tall > 1 or deep > 1 or e0 > k0 or e1 > k1 or e2 > k2 or e3 > k3:
            slows += 1
        lane += 1
    w = int(0)
    while w < hits:
        q = hit_lane[w]
        k = hit_k[w]
        stop = wp.min(k + LANES, count)
        i = first + q
        while k < stop:
            distance = square_between(listed, size, i, k)
            if distance < best[q] and k != i:
                best[q] = distance
                near[q] = k
            k += 1
        w += 1
    w = int(0)
    while w < slows:
        q = slow[w]
        if near[q] >= 0 or best[q] > 0.0:
            near[q] = search_cells(grid, begin, listed, size, first + q, near[q], best[q])
        w += 1
    lane = int(0)
    while lane < n:
        notes_out[NEAREST * size + first + lane] = near[lane]
        lane += 1
