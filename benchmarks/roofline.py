"""The least time that the workload can take on this machine, by what it must move and compute.

**Bytes** a particle step, float32 and int32, if every array goes through memory once in each of the three
passes that wait for each other (nobody can search before all are sorted, nor move before all have searched):

=======  =====================================================================  =====
sort     read place, velocity, rate or mass, number, last neighbour: 3+3+1+1+1     36
         write them in order; place and number are the record at the same time     36
search   read place, last neighbour; write neighbour and distance                  24
move     read place, velocity, mass, number, neighbour, distance                   40
         write place, velocity, mass, number                                       32
=======  =====================================================================  =====

which is `BYTES` = 168. Neighbours, cells and fields are taken to stay in the caches.

**Operations** a particle step, each addition, multiplication, minimum, division and square root as one: a
look-up takes 15 to find the cells and fractions of both views, 12 for the weights, 28 for the four products
of both components of both views, 3 to add them up: 58. The rest of a stage takes 13 for the direction's and
the place's length, 6 for the blending, 8 for the gap and its length, 6 for the pull, 21 for the
acceleration, 24 for the sums and the next stage: 78. Four stages and the end of the step: 4 * 136 + 12 =
556. The search takes 8 for a candidate and hardly fewer than 20 candidates, even where the answer is known
before: 160. `OPERATIONS` = 716.

A program takes at least as long as its bytes at the machine's bandwidth and its operations at the machine's
rate in vectors. The second floor is of practice: the look-ups alone, in the best form known here
(`numba_motion.look_up`), 16 loads a look-up from places that only the particle knows. All are measured on all
cores, in this process.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any, NamedTuple

import numba
import numpy as np
from numba import njit, prange

from benchmarks.peers.numba_motion import BLOCK, OPTIONS, look_up, scratch_space
from benchmarks.workload import make_workload
from flowtree.device import thread_count

BYTES, OPERATIONS = 168, 716  # a particle step; see above

_ARRAY = 16_000_000  # float32 of an array to copy: more than caches hold
_ROUNDS = 4000  # of multiplying and adding
_PARTICLES = 200_000
_NUMBERS, _DEPTH = 4096, 64  # numbers that are multiplied and added, each so often in a round


class Machine(NamedTuple):
    """What all cores reach together.

    bandwidth: of copying, each byte counted read and written [B/s].
    rate: of multiplications and additions in vectors [1/s].
    look_ups: time of the four look-ups of one particle step [s].
    """

    bandwidth: float
    rate: float
    look_ups: float

    def floor(self, steps: int) -> float:
        """Least time of so many particle steps by bytes and operations [s]."""
        return steps * max(BYTES / self.bandwidth, OPERATIONS / self.rate)


def measure_machine() -> Machine:
    """Measures the three, each as the best of several rounds."""
    threads = thread_count()
    numba.set_num_threads(threads)
    return Machine(_measure_bandwidth(threads), _measure_rate(threads), _measure_look_ups(threads))


def print_roofline(machine: Machine, program: str, size: int, seconds: float, steps: int) -> None:
    """The floors beside what a program took."""
    floor, look_ups = machine.floor(steps), steps * machine.look_ups
    print(f"roofline.bandwidth {machine.bandwidth / 1e9:.1f} GB/s, {BYTES} B a particle step")
    print(f"roofline.rate {machine.rate / 1e9:.0f} Gop/s, {OPERATIONS} operations a particle step")
    print(f"roofline.look_ups {1e9 * machine.look_ups:.1f} ns a particle step for the look-ups alone")
    print(f"roofline.{size}.floor {floor:.3f} s, of the look-ups alone {look_ups:.3f} s")
    print(
        f"roofline.{size}.{program} {seconds:.3f} s: {seconds / floor:.1f} times the floor, "
        f"{seconds / look_ups:.1f} times the look-ups alone"
    )


def _best(work: Callable[[], Any]) -> float:
    work()
    seconds = []
    for _ in range(5):
        start = time.perf_counter()
        work()
        seconds.append(time.perf_counter() - start)
    return min(seconds)


def _measure_bandwidth(threads: int) -> float:
    source, target = np.ones(_ARRAY, np.float32), np.zeros(_ARRAY, np.float32)
    parts = list(zip(np.array_split(target, threads), np.array_split(source, threads), strict=True))
    with ThreadPoolExecutor(threads) as pool:
        seconds = _best(lambda: list(pool.map(lambda pair: np.copyto(*pair), parts)))
    return 2 * source.nbytes / seconds


def _measure_rate(threads: int) -> float:
    numbers = np.full((threads, _NUMBERS), 0.1, np.float32)
    seconds = _best(lambda: _multiply_and_add(numbers, _ROUNDS))
    return threads * _NUMBERS * _ROUNDS * _DEPTH * 2 / seconds


def _measure_look_ups(threads: int) -> float:
    """Of particles in the order of cells, as they are in the flow."""
    workload = make_workload(_PARTICLES)
    cells = np.floor(workload.start * 40).astype(int)
    order = np.lexsort(cells.T)
    x, y, z = workload.start[order].T.copy()
    scratch, index = scratch_space(threads)
    field = workload.vectors.ravel()
    return _best(lambda: _only_look_up(field, x, y, z, scratch, index, threads)) / _PARTICLES


@njit(parallel=True, **OPTIONS)
def _multiply_and_add(numbers, rounds):
    for t in prange(len(numbers)):
        mine = numbers[t]
        for _ in range(rounds):
            for k in range(_NUMBERS):
                value = mine[k]
                for _ in range(_DEPTH):
                    value = value * value - np.float32(0.5)  # stays within 1
                mine[k] = value


@njit(parallel=True, **OPTIONS)
def _only_look_up(field, x, y, z, scratch, index, threads):
    """Four times where each particle is; the places go in and the vectors stay in the scratch array."""
    for t in prange(threads):
        s, cell = scratch[t], index[t]
        start, stop = len(x) * t // threads, len(x) * (t + 1) // threads
        for first in range(start, stop, BLOCK):
            length = min(BLOCK, stop - first)
            for k in range(length):
                at = np.uint64(10 * BLOCK + k)  # the rows of the stage's place
                i = np.uint64(first + k)
                s[at], s[at + np.uint64(BLOCK)], s[at + np.uint64(2 * BLOCK)] = x[i], y[i], z[i]
            _look_up_four_times(field, cell, s, length)


@njit(**OPTIONS)
def _look_up_four_times(field, cell, s, length):
    for _ in range(4):
        look_up(field, cell, s, length)
