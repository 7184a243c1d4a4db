"""The nearest neighbours of a block of particles, found together (section 6)."""

import warp as wp

from flowtree.kernels.living_cells import LivingCells, cells_around
from flowtree.kernels.swarm import Y, Z

# Loops over the lanes of a block must stay loops: the compiler makes vector instructions of sixteen rounds.
wp.set_module_options({"enable_backward": False, "max_unroll": 8})

BLOCK = wp.constant(64)  # particles whose neighbours are looked for together
LANES = wp.constant(16)  # places compared at once
# Warp takes a negative index from the end: told that there is none, the compiler loads sixteen at once.
NOT_NEGATIVE = wp.constant(0x7FFFFFFF)
ITEMS = wp.constant(512)  # stretches of the list that a block may ask to be compared
Floats = wp.types.vector(length=64, dtype=float)
Wholes = wp.types.vector(length=64, dtype=int)
Items = wp.types.vector(length=512, dtype=int)


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
    before: wp.array[int],
    moved: wp.array[int],
    i: int,
):
    """Somebody near, to bound the search: the nearest of the last step, else one beside in the list.

    before: the nearest, as places in the last step's list.
    moved: where those places have gone to in this one; -1 for who has arrived, -2 - p for who joined p.
    """
    near = before[i]
    if near >= 0:
        near = moved[near]
        if near < -1:
            near = moved[-2 - near]
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
    before: wp.array[int],
    moved: wp.array[int],
    radius: float,
    first: int,
    last: int,
    nearest_out: wp.array[int],
):
    """The nearest within the radius, as a place in the sorted list or -1, from ``first`` to before ``last``.

    Exact: a particle's nearest of the last step bounds the search, wherever that one is now, so the reach
    follows the local density. Step by step for at most `BLOCK` particles at once, so that no step has to
    guess how another one branches: the bounds; the rows of cells that each ball touches, cut into stretches
    of the list; how many are nearer than the bound in each stretch, sixteen places at once (most hold none);
    the few stretches that hold one.
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
    item_k = Items()
    item_lane = Items()
    hit = Items()
    n = last - first
    lane = int(0)
    while lane < n:
        i = first + lane
        px[lane] = listed[i]
        py[lane] = listed[Y * size + i]
        pz[lane] = listed[Z * size + i]
        guess = guess_nearest(listed, size, count, before, moved, i)
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
    items = int(0)
    slows = int(0)
    lane = int(0)
    while lane < n:
        tall = high[lane] - low[lane]
        deep = front[lane] - back[lane]
        fits = tall <= 1 and deep <= 1 and items <= ITEMS - 20
        if fits:
            was = items
            part = int(0)
            while part < 4:
                dy = part & 1
                dz = part >> 1
                row = grid.nx * (
                    wp.min(low[lane] + dy, high[lane]) + grid.ny * wp.min(back[lane] + dz, front[lane])
                )
                k = begin[(row + left[lane]) & NOT_NEGATIVE]
                stop = begin[(row + right[lane] + 1) & NOT_NEGATIVE]
                stop = wp.where(dy <= tall and dz <= deep, stop, k)
                item_k[items] = k
                item_lane[items] = lane
                items += wp.where(stop > k, 1, 0)
                k += LANES
                if k < stop:
                    if stop - k > 4 * LANES:
                        fits = bool(False)
                        stop = k
                    while k < stop:
                        item_k[items] = k
                        item_lane[items] = lane
                        items += 1
                        k += LANES
                part += 1
            items = wp.where(fits, items, was)
        slow[slows] = lane
        slows += wp.where(fits, 0, 1)
        lane += 1
    row_y = (Y * size) & NOT_NEGATIVE
    row_z = (Z * size) & NOT_NEGATIVE
    hits = int(0)
    w = int(0)
    while w < items:
        k = item_k[w] & NOT_NEGATIVE
        q = item_lane[w]
        ax = px[q]
        ay = py[q]
        az = pz[q]
        limit = best[q]
        nearer = int(0)
        for s in range(LANES):
            dx = listed[k + s] - ax
            dy_ = listed[row_y + k + s] - ay
            dz_ = listed[row_z + k + s] - az
            nearer += wp.where(dx * dx + dy_ * dy_ + dz_ * dz_ < limit, 1, 0)
        own = first + q - k
        nearer -= wp.where(own >= 0 and own < LANES, 1, 0)
        hit[hits] = w
        hits += wp.where(nearer > 0, 1, 0)
        w += 1
    w = int(0)
    while w < hits:
        item = hit[w]
        q = item_lane[item]
        k = item_k[item]
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
        nearest_out[first + lane] = near[lane]
        lane += 1
