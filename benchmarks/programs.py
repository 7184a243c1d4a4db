"""The programs that trace the workload, by the name that reports give them."""

from __future__ import annotations

from typing import Protocol

from benchmarks.peers.trace_hashgrid import trace_hashgrid
from benchmarks.peers.trace_numba import trace_numba
from benchmarks.peers.trace_numpy import trace_numpy
from benchmarks.workload import Program, Traced, Workload


class Threaded(Protocol):
    """A program that can be told how many cores to use."""

    def __call__(self, workload: Workload, *, threads: int | None = None) -> Traced:
        """Traces the workload; on all cores without a number."""


#: Those that take a number of cores.
THREADED: dict[str, Threaded] = {"numba": trace_numba}

#: All of them; the first of those that run is what the others' results are compared with.
PROGRAMS: dict[str, Program] = {"numpy": trace_numpy, **THREADED, "hashgrid": trace_hashgrid}
