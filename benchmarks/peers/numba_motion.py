"""How the particles move in `trace_numba`: joining, forces and Runge-Kutta, in blocks for vector units.

A block is copied to a scratch array of rows, one a quantity, and each stage is three loops over it: places in
the fields' grids and arithmetic are loops without a branch, which LLVM turns into vector instructions; the
look-ups between them stay scalar. (In one loop nothing is vectorised, since LLVM cannot know that what is
written to the scratch array is not the field: 73 ns a particle in place of 30 on an AVX-512 core.)
Indices are unsigned where they can be: Numba checks others for being negative.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numba import njit, prange
from numpy.typing import NDArray

from benchmarks.workload import ARRIVAL, BASIN, CELL, CELLS, INERTIA, LEFT, RESPONSE, STEP

OPTIONS: dict[str, Any] = {"fastmath": True, "error_model": "numpy", "cache": True}
BLOCK = 64
ROWS = 28  # of the scratch array
FAR = np.float32(1e6)  # too far away to attract or to be near
MOST = np.float32(3e38)

f4, i4, index = np.float32, np.int32, np.uint64
_ZERO, _HALF, _ONE, _TWO = f4(0), f4(0.5), f4(1), f4(2)
_TINY = f4(1e-30)
_CELLS_A_UNIT, _MIDDLE, _LAST = f4(1 / CELL), f4(-LEFT / CELL - 0.5), f4(CELLS - 1)
_LAST_CELL = i4(CELLS - 2)
_BASINS_A_UNIT, _ARRIVAL_SQUARE = f4(1 / BASIN), f4(ARRIVAL**2)
_RESPONSE, _INERTIA, _MOST_RATE = f4(RESPONSE), f4(INERTIA), f4(1 / STEP)
_STEP, _HALF_STEP, _SIXTH_STEP = f4(STEP), f4(STEP / 2), f4(STEP / 6)

# Beginnings of rows: of place and velocity at the beginning of the step, of what attracts, of the rate,
# of place and velocity of the stage, of the place within a cell, of the fields' vector, of the weighted sums.
_X, _Y, _Z, _VX, _VY, _VZ, _GX, _GY, _GZ, _RATE = (index(BLOCK * k) for k in range(10))
_SX, _SY, _SZ, _SVX, _SVY, _SVZ = (index(BLOCK * k) for k in range(10, 16))
_SIDE, _RISE, _DEPTH, _WX, _WY, _WZ = (index(BLOCK * k) for k in range(16, 22))
_SUM = index(BLOCK * 22)
_SUM_X, _SUM_Y, _SUM_Z, _SUM_VX, _SUM_VY, _SUM_VZ = (index(BLOCK * k) for k in range(22, 28))
# Steps through a field that is laid out flat: two numbers a cell.
_UP, _RIGHT, _RIGHT_UP = index(1), index(2), index(3)
_ROW = index(2 * CELLS)
_ALL = i4(CELLS * CELLS)


@njit(forceinline=True, **OPTIONS)
def look_up(field, cell, s, count):
    """The sum of both fields' vectors at the stage's places."""
    for k in range(count):
        i = index(k)
        u = min(max(s[_SX + i] * _CELLS_A_UNIT + _MIDDLE, _ZERO), _LAST)
        w = min(max(_MIDDLE - s[_SZ + i] * _CELLS_A_UNIT, _ZERO), _LAST)
        v = min(max(s[_SY + i] * _CELLS_A_UNIT - _HALF, _ZERO), _LAST)
        column = min(i4(u), _LAST_CELL)
        depth = min(i4(w), _LAST_CELL)
        row = min(i4(v), _LAST_CELL)
        s[_SIDE + i] = u - f4(column)
        s[_DEPTH + i] = w - f4(depth)
        s[_RISE + i] = v - f4(row)
        cell[i] = row * i4(CELLS) + column
        cell[index(BLOCK) + i] = row * i4(CELLS) + depth + _ALL
    for k in range(count):
        i = index(k)
        a, b, c = s[_SIDE + i], s[_RISE + i], s[_DEPTH + i]
        at, under = index(cell[i]) * _RIGHT, index(cell[index(BLOCK) + i]) * _RIGHT
        low = _ONE - b
        f0, f1, f2, f3 = (_ONE - a) * low, a * low, (_ONE - a) * b, a * b
        x = field[at] * f0 + field[at + _RIGHT] * f1
        x += field[at + _ROW] * f2 + field[at + _ROW + _RIGHT] * f3
        y = field[at + _UP] * f0 + field[at + _RIGHT_UP] * f1
        y += field[at + _ROW + _UP] * f2 + field[at + _ROW + _RIGHT_UP] * f3
        f0, f1, f2, f3 = (_ONE - c) * low, c * low, (_ONE - c) * b, c * b
        z = field[under] * f0 + field[under + _RIGHT] * f1
        z += field[under + _ROW] * f2 + field[under + _ROW + _RIGHT] * f3
        y += field[under + _UP] * f0 + field[under + _RIGHT_UP] * f1
        y += field[under + _ROW + _UP] * f2 + field[under + _ROW + _RIGHT_UP] * f3
        s[_WX + i] = x
        s[_WY + i] = _HALF * y
        s[_WZ + i] = -z


@njit(forceinline=True, **OPTIONS)
def _run_stage(field, cell, s, count, per_radius, weight, ahead):
    """Adds the stage's velocity and acceleration to the sums; the next lies ``ahead`` of the beginning."""
    look_up(field, cell, s, count)
    for k in range(count):
        i = index(k)
        x, y, z = s[_SX + i], s[_SY + i], s[_SZ + i]
        vx, vy, vz = s[_SVX + i], s[_SVY + i], s[_SVZ + i]
        wx, wy, wz = s[_WX + i], s[_WY + i], s[_WZ + i]
        far = math.sqrt(x * x + y * y + z * z)
        free = min(far * _BASINS_A_UNIT, _ONE) * min(max(_ONE + y * _BASINS_A_UNIT, _ZERO), _ONE)
        along = free / math.sqrt(wx * wx + wy * wy + wz * wz)
        home = (_ONE - free) / (far + _TINY)
        gx, gy, gz = s[_GX + i] - x, s[_GY + i] - y, s[_GZ + i] - z
        gap = math.sqrt(gx * gx + gy * gy + gz * gz)
        pull = max(_ONE - gap * per_radius, _ZERO) / (gap + _TINY)
        rate = s[_RATE + i]
        ax = (wx * along - x * home + gx * pull - vx) * rate
        ay = (wy * along - y * home + gy * pull - vy) * rate
        az = (wz * along - z * home + gz * pull - vz) * rate
        s[_SUM_X + i] += weight * vx
        s[_SUM_Y + i] += weight * vy
        s[_SUM_Z + i] += weight * vz
        s[_SUM_VX + i] += weight * ax
        s[_SUM_VY + i] += weight * ay
        s[_SUM_VZ + i] += weight * az
        s[_SX + i] = s[_X + i] + ahead * vx
        s[_SY + i] = s[_Y + i] + ahead * vy
        s[_SZ + i] = s[_Z + i] + ahead * vz
        s[_SVX + i] = s[_VX + i] + ahead * ax
        s[_SVY + i] = s[_VY + i] + ahead * ay
        s[_SVZ + i] = s[_VZ + i] + ahead * az


@njit(**OPTIONS)
def advance_block(field, cell, s, count, per_radius):
    """One step of the classical Runge-Kutta method for the first ``count`` of a block."""
    size = index(6 * BLOCK)
    for k in range(6 * BLOCK):
        i = index(k)
        s[_SX + i] = s[i]
        s[_SUM + i] = _ZERO
    _run_stage(field, cell, s, count, per_radius, _ONE, _HALF_STEP)
    _run_stage(field, cell, s, count, per_radius, _TWO, _HALF_STEP)
    _run_stage(field, cell, s, count, per_radius, _TWO, _STEP)
    _run_stage(field, cell, s, count, per_radius, _ONE, _STEP)
    for k in range(size):
        i = index(k)
        s[i] += _SIXTH_STEP * s[_SUM + i]


def move(
    field, px, py, pz, who, motion, mass, near, square, threshold_square, per_radius,
    x, y, z, who_out, motion_out, mass_out, alive, joined, end_step, number, box, ended, scratch, cells,
    threads,
):  # fmt: skip
    """Joins and advances all particles, each thread its share; `trace_numba` compiles it parallel and serial.

    Who loses its pair is advanced as well, for nothing: a branch less in the loops over blocks.
    ``box`` gets the bounds of each thread's living, ``ended`` the numbers of its living and arrived.
    """
    count = len(near)
    for t in prange(threads):
        s = scratch[t]
        cell = cells[t]
        left, low, back, right, high, front = MOST, MOST, MOST, -MOST, -MOST, -MOST
        living = arrived = 0
        start, stop = count * t // threads, count * (t + 1) // threads
        for first in range(start, stop, BLOCK):
            length = min(BLOCK, stop - first)
            for k in range(length):
                u, i = index(k), index(first + k)
                m = index(4) * i
                _load(s, u, px[i], py[i], pz[i], motion[m], motion[m + _UP], motion[m + _RIGHT])
                s[_RATE + u] = motion[m + _RIGHT_UP]
                s[_GX + u] = s[_GY + u] = s[_GZ + u] = FAR
                alive[i], mass_out[i], who_out[i] = True, mass[i], who[i]
                if near[i] < 0:
                    continue
                j = index(near[i])
                if square[i] >= threshold_square or near[j] != first + k:
                    s[_GX + u], s[_GY + u], s[_GZ + u] = px[j], py[j], pz[j]
                elif mass[i] > mass[j] or (mass[i] == mass[j] and who[i] < who[j]):
                    n = index(4) * j
                    total = mass[i] + mass[j]
                    a, b = mass[i] / total, mass[j] / total
                    _load(
                        s, u, a * px[i] + b * px[j], a * py[i] + b * py[j], a * pz[i] + b * pz[j],
                        a * motion[m] + b * motion[n], a * motion[m + _UP] + b * motion[n + _UP],
                        a * motion[m + _RIGHT] + b * motion[n + _RIGHT],
                    )  # fmt: skip
                    mass_out[i] = total
                    s[_RATE + u] = min(_ONE / (_RESPONSE * total**_INERTIA), _MOST_RATE)
                else:
                    alive[i] = False
                    joined[index(who[i])], end_step[index(who[i])] = who[j], number
            advance_block(field, cell, s, length, per_radius)
            for k in range(length):
                u, i = index(k), index(first + k)
                m = index(4) * i
                ax, ay, az = s[_X + u], s[_Y + u], s[_Z + u]
                x[i], y[i], z[i] = ax, ay, az
                motion_out[m], motion_out[m + _UP] = s[_VX + u], s[_VY + u]
                motion_out[m + _RIGHT], motion_out[m + _RIGHT_UP] = s[_VZ + u], s[_RATE + u]
                if not alive[i]:
                    continue
                if ax * ax + ay * ay + az * az < _ARRIVAL_SQUARE:
                    alive[i], end_step[index(who[i])] = False, number
                    arrived += 1
                else:
                    living += 1
                    left, low, back = min(left, ax), min(low, ay), min(back, az)
                    right, high, front = max(right, ax), max(high, ay), max(front, az)
        box[t, 0], box[t, 1], box[t, 2] = left, low, back
        box[t, 3], box[t, 4], box[t, 5] = right, high, front
        ended[t, 0], ended[t, 1] = living, arrived


@njit(forceinline=True, **OPTIONS)
def _load(s, u, x, y, z, vx, vy, vz):
    s[_X + u], s[_Y + u], s[_Z + u] = x, y, z
    s[_VX + u], s[_VY + u], s[_VZ + u] = vx, vy, vz


def scratch_space(threads: int) -> tuple[NDArray[np.float32], NDArray[np.int32]]:
    """What `move` needs for each thread."""
    return np.zeros((threads, ROWS * BLOCK), np.float32), np.zeros((threads, 2 * BLOCK), np.int32)
