"""The workload with Numba on all cores: sorted cell list, vectorised motion, no Python within the loop.

What was tried and is slower on two cores of an EPYC 9005: cells of 1.2 or 2 mean spacings; rings of cells
outwards from the particle's own; candidates one by one (the search takes 2.3 times as long) or 32 together;
places as triples; one loop a step for the motion (2.4 times); tbb or workqueue for the threading layer
(1.3 and 10 times as long at 2,000 particles).

Numba looks for a change only in the file whose functions it has cached: after one in `numba_motion` or
`numba_neighbours` touch this file too.
"""

from __future__ import annotations

import numba
import numpy as np
from numba import njit

from benchmarks.peers.numba_motion import FAR, MOST, OPTIONS, move, scratch_space
from benchmarks.peers.numba_neighbours import WIDTH, count_cells, lay_out_cells, search, sort_particles
from benchmarks.workload import MOST_STEPS, RESPONSE, Traced, Workload
from flowtree.device import thread_count

_SPACINGS = np.float32(1.6)  # width of a cell
_SERIAL_BELOW = 100  # living particles: a parallel loop costs a microsecond or two

f4, i4 = np.float32, np.int32
_parallel = njit(parallel=True, **OPTIONS)
_serial = njit(**OPTIONS)
_count_parallel, _count_serial = _parallel(count_cells), _serial(count_cells)
_lay_out_parallel, _lay_out_serial = _parallel(lay_out_cells), _serial(lay_out_cells)
_sort_parallel, _sort_serial = _parallel(sort_particles), _serial(sort_particles)
_search_parallel, _search_serial = _parallel(search), _serial(search)
_move_parallel, _move_serial = _parallel(move), _serial(move)


def trace_numba(workload: Workload, *, threads: int | None = None) -> Traced:
    """Traces all particles; records are x, y, z and the particles of all steps, and the steps' lengths.

    Within a step they are in the order of the cells.
    """
    threads = thread_count() if threads is None else threads
    count = len(workload.start)
    joined, end_step = np.full(count, -1, i4), np.full(count, -1, i4)
    numba.set_num_threads(threads)
    records, lengths, arrived = _run(
        np.ascontiguousarray(workload.vectors).ravel(),
        *workload.start.T.copy(),  # they are moved in place
        f4(workload.radius),
        f4(workload.threshold),
        *scratch_space(threads),
        *(np.empty(32 * count + 65536, kind) for kind in (f4, f4, f4, i4)),
        joined,
        end_step,
        threads,
    )
    return Traced(joined, end_step, int(arrived), int(lengths.sum()), (records, lengths))


@njit(**OPTIONS)
def _run(field, x, y, z, radius, threshold, scratch, cells, rx, ry, rz, rwho, joined, end_step, threads):
    """All steps. Places are sorted straight into the record, and are searched and read there."""
    count = len(x)
    who, motion, mass = np.arange(count).astype(i4), np.zeros(4 * count, f4), np.ones(count, f4)
    motion[3::4] = f4(1 / RESPONSE)  # velocity and rate
    motion_in, mass_in, alive = np.empty_like(motion), np.empty_like(mass), np.ones(count, np.bool_)
    near, square, guess = np.full(count, -1, i4), np.empty(count, f4), np.empty(count, i4)
    key, place = np.empty(count, i4), np.empty(count, i4)
    histogram, begin = np.empty((threads, 2 * count + 64), i4), np.empty(2 * count + 64, i4)
    part, ended, box = np.empty(threads, i4), np.empty((threads, 2), np.int64), np.empty((threads, 6), f4)
    corner, shape = np.empty(3, f4), np.empty(3, i4)
    lengths = np.zeros(MOST_STEPS, np.int64)
    low, high = _bound(x, y, z)
    total, living, arrived, number = 0, count, 0, np.int64(0)  # no literal: all is compiled for each anew
    while living > 0 and number < MOST_STEPS:
        if total + living + WIDTH > len(rx):
            rx, ry, rz, rwho = _grow(rx), _grow(ry), _grow(rz), _grow(rwho)
        px, py, pz, pwho = rx[total:], ry[total:], rz[total:], rwho[total:]
        for row in (px, py, pz):
            row[living : living + WIDTH] = FAR
        per_width = _lay_grid(low, high, living, radius, len(begin), corner, shape)
        all_cells = shape[0] * shape[1] * shape[2]
        now, far, close = near[:living], radius * radius, threshold * threshold
        if count < _SERIAL_BELOW:
            used = 1
            _count_serial(x[:count], y, z, alive, corner, per_width, shape, key, histogram, 1)
            _lay_out_serial(histogram, begin, all_cells, 1, part)
            _sort_serial(
                x, y, z, who, motion, mass, near, key[:count], histogram,
                px, py, pz, pwho, motion_in, mass_in, guess, place, 1,
            )  # fmt: skip
            _search_serial(
                px, py, pz, pwho, begin, corner, per_width, shape, far, guess, place, now, square, 1
            )
            _move_serial(
                field, px, py, pz, pwho, motion_in, mass_in, now, square, close, f4(1) / radius,
                x, y, z, who, motion, mass, alive, joined, end_step, number, box, ended, scratch, cells, 1,
            )  # fmt: skip
        else:
            used = threads
            _count_parallel(x[:count], y, z, alive, corner, per_width, shape, key, histogram, threads)
            _lay_out_parallel(histogram, begin, all_cells, threads, part)
            _sort_parallel(
                x, y, z, who, motion, mass, near, key[:count], histogram,
                px, py, pz, pwho, motion_in, mass_in, guess, place, threads,
            )  # fmt: skip
            _search_parallel(
                px, py, pz, pwho, begin, corner, per_width, shape, far, guess, place, now, square, threads
            )
            _move_parallel(
                field, px, py, pz, pwho, motion_in, mass_in, now, square, close, f4(1) / radius,
                x, y, z, who, motion, mass, alive, joined, end_step, number, box, ended, scratch, cells,
                threads,
            )  # fmt: skip
        lengths[number] = living
        number += 1
        total += living
        count, living = living, 0
        low[:], high[:] = MOST, -MOST
        for t in range(used):
            living += ended[t, 0]
            arrived += ended[t, 1]
            for axis in range(3):
                low[axis] = min(low[axis], box[t, axis])
                high[axis] = max(high[axis], box[t, 3 + axis])
    return (rx[:total], ry[:total], rz[:total], rwho[:total]), lengths[:number], arrived


@njit(**OPTIONS)
def _bound(x, y, z):
    low, high = np.full(3, MOST, f4), np.full(3, -MOST, f4)
    for axis, values in enumerate((x, y, z)):
        for value in values:
            low[axis], high[axis] = min(low[axis], value), max(high[axis], value)
    return low, high


@njit(**OPTIONS)
def _lay_grid(low, high, living, radius, most_cells, corner, shape):
    """Cells by the mean spacing of the living in their bounding box; returns cells a unit."""
    volume = f4(1)
    for axis in range(3):
        corner[axis] = low[axis]
        volume *= max(high[axis] - low[axis], radius)
    width = _SPACINGS * f4((volume / f4(living)) ** f4(1 / 3))
    while True:
        cells = 1
        for axis in range(3):
            shape[axis] = i4((high[axis] - low[axis]) / width) + 1
            cells *= shape[axis]
        if cells < most_cells:
            return f4(1) / width
        width *= f4(1.2)


@njit(**OPTIONS)
def _grow(values):
    more = np.empty(2 * len(values), values.dtype)
    more[: len(values)] = values
    return more
