"""The sorted cell list of `trace_numba` and the search for the nearest neighbour in it.

The functions without a decorator are compiled in parallel and serial by `trace_numba`.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit, prange

from benchmarks.peers.numba_motion import MOST, OPTIONS

WIDTH = 16  # candidates that are looked at together: a vector of AVX-512

f4, i4, index = np.float32, np.int32, np.uint64
_NOBODY, _ONE, _WIDTH = i4(-1), i4(1), i4(WIDTH)
_ZERO = f4(0)
_LOOSE, _LITTLE = f4(1.00001), f4(1e-5)  # what rounding may take from a distance in cells


def count_cells(x, y, z, alive, corner, per_width, shape, key, histogram, threads):
    """The cell of every living particle, and how many each thread's share has in each cell."""
    cells = shape[0] * shape[1] * shape[2]
    left, low, back = corner[0], corner[1], corner[2]
    nx, ny, nz = shape[0], shape[1], shape[2]
    count = len(x)
    for t in prange(threads):
        mine = histogram[t]
        mine[:cells] = 0
        for k in range(count * t // threads, count * (t + 1) // threads):
            i = index(k)
            column = min(max(i4((x[i] - left) * per_width), i4(0)), nx - _ONE)
            row = min(max(i4((y[i] - low) * per_width), i4(0)), ny - _ONE)
            layer = min(max(i4((z[i] - back) * per_width), i4(0)), nz - _ONE)
            key[i] = i4(column + nx * (row + ny * layer)) if alive[i] else _NOBODY
        for k in range(count * t // threads, count * (t + 1) // threads):
            cell = key[index(k)]
            if cell >= 0:
                mine[index(cell)] += _ONE


def lay_out_cells(histogram, begin, cells, threads, part):
    """Turns numbers in cells into beginnings: of each cell, and of each thread's share within it."""
    for t in prange(threads):
        total = i4(0)
        for other in range(threads):
            for cell in range(cells * t // threads, cells * (t + 1) // threads):
                total += histogram[other, index(cell)]
        part[t] = total
    base = i4(0)
    for t in range(threads):
        part[t], base = base, i4(base + part[t])
    for t in prange(threads):
        at = part[t]
        for k in range(cells * t // threads, cells * (t + 1) // threads):
            cell = index(k)
            begin[cell] = at
            for other in range(threads):
                number = histogram[other, cell]
                histogram[other, cell] = at
                at += number
    begin[cells] = base


def sort_particles(
    x, y, z, who, motion, mass, near, key, histogram,
    x_out, y_out, z_out, who_out, motion_out, mass_out, guess, place, threads,
):  # fmt: skip
    """Moves the living to their places in the sorted list; the others drop out.

    ``place`` says where each went, or below -1 whom it had for its nearest: who lost its pair is now there.
    """
    count = len(key)
    for t in prange(threads):
        mine = histogram[t]
        for k in range(count * t // threads, count * (t + 1) // threads):
            i = index(k)
            if key[i] < 0:
                place[i] = i4(-2) - near[i]
                continue
            at = mine[index(key[i])]
            mine[index(key[i])] = at + _ONE
            place[i] = at
            to = index(at)
            x_out[to], y_out[to], z_out[to] = x[i], y[i], z[i]
            who_out[to], mass_out[to], guess[to] = who[i], mass[i], near[i]
            a, b = index(4) * i, index(4) * to
            motion_out[b], motion_out[b + index(1)] = motion[a], motion[a + index(1)]
            motion_out[b + index(2)], motion_out[b + index(3)] = motion[a + index(2)], motion[a + index(3)]


def search(
    px, py, pz, who, begin, corner, per_width, shape, radius_square, guess, place, near, square, threads
):
    """The nearest neighbour of every particle and the square of its distance; -1 where nobody is near.

    Last step's nearest, which is it again in nine of ten cases, bounds the search from the beginning.
    """
    count = len(near)
    nx, ny, nz = shape[0], shape[1], shape[2]
    left, low, back = corner[0], corner[1], corner[2]
    for t in prange(threads):
        for k in range(count * t // threads, count * (t + 1) // threads):
            i = index(k)
            hint = guess[i]
            if hint >= 0:
                hint = place[index(hint)]
                if hint < _NOBODY:
                    hint = place[index(i4(-2) - hint)]
            near[i], square[i] = _find_nearest(
                i4(k), px, py, pz, who, begin, left, low, back, per_width, nx, ny, nz, radius_square, hint
            )


@njit(**OPTIONS)
def _find_nearest(i, px, py, pz, who, begin, left, low, back, per_width, nx, ny, nz, radius_square, hint):
    """Scans the rows of cells that the ball around the particle touches; it shrinks with what is found."""
    x, y, z = px[index(i)], py[index(i)], pz[index(i)]
    best, near = _try(px, py, pz, x, y, z, i, hint, radius_square, _NOBODY)
    if near < 0:
        if i + _ONE < len(px):
            best, near = _try(px, py, pz, x, y, z, i, i4(i + _ONE), best, near)
        best, near = _try(px, py, pz, x, y, z, i, i4(i - _ONE), best, near)
    column, row, layer = (x - left) * per_width, (y - low) * per_width, (z - back) * per_width
    reach = math.sqrt(best) * per_width * _LOOSE + _LITTLE  # in cells
    first, last = max(i4(column - reach), i4(0)), min(i4(column + reach), nx - _ONE)
    below, above = max(i4(row - reach), i4(0)), min(i4(row + reach), ny - _ONE)
    for c in range(max(i4(layer - reach), i4(0)), min(i4(layer + reach), nz - _ONE) + 1):
        gz = max(max(f4(c) - layer, layer - f4(c + 1)), _ZERO)
        for b in range(below, above + 1):
            gy = max(max(f4(b) - row, row - f4(b + 1)), _ZERO)
            if gz * gz + gy * gy <= reach * reach:
                start = nx * (b + ny * c)
                before = best
                best, near = _scan(
                    px, py, pz, who, x, y, z, i, begin[index(start + first)], begin[index(start + last + 1)],
                    best, near,
                )  # fmt: skip
                if best < before:
                    reach = math.sqrt(best) * per_width * _LOOSE + _LITTLE
                    first, last = max(i4(column - reach), i4(0)), min(i4(column + reach), nx - _ONE)
    return near, best


@njit(forceinline=True, **OPTIONS)
def _try(px, py, pz, x, y, z, i, j, best, near):
    """Takes one candidate if it is nearer."""
    if j >= 0 and j != i:
        dx, dy, dz = px[index(j)] - x, py[index(j)] - y, pz[index(j)] - z
        square = dx * dx + dy * dy + dz * dz
        if square < best:
            best, near = square, j
    return best, near


@njit(forceinline=True, **OPTIONS)
def _scan(px, py, pz, who, x, y, z, i, start, stop, best, near):
    """The best of a part of the sorted list; of equally near ones the lowest particle.

    A vector of candidates is first asked whether any is nearer at all, which takes no branch. It may reach
    beyond the part: those are particles too, and behind the last lie places far away.
    """
    while start < stop:
        first = index(start)
        myself, known = i4(i - start), i4(near - start)
        nearer = i4(0)
        for k in range(WIDTH):
            j = first + index(k)
            dx, dy, dz = px[j] - x, py[j] - y, pz[j] - z
            square = dx * dx + dy * dy + dz * dz
            square = MOST if i4(k) == myself else square
            square = MOST if i4(k) == known else square
            nearer = i4(nearer + i4(square <= best))
        if nearer > 0:
            for k in range(WIDTH):
                j = first + index(k)
                dx, dy, dz = px[j] - x, py[j] - y, pz[j] - z
                square = dx * dx + dy * dy + dz * dz
                lower = square < best or (near >= 0 and who[j] < who[index(near)])
                if square <= best and lower and i4(k) != myself:
                    best, near = square, i4(start + i4(k))
        start = i4(start + _WIDTH)
    return best, near
