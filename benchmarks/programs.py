"""The programs that trace the workload, by the name that reports give them."""

from __future__ import annotations

from functools import partial
from typing import Protocol

from benchmarks.peers.trace_hashgrid import trace_hashgrid
from benchmarks.peers.trace_numba import trace_numba
from benchmarks.peers.trace_numpy import trace_numpy
from benchmarks.trace_flowtree import trace_flowtree
from benchmarks.workload import Program, Traced, Workload
from flowtree.device import pick_device


class Threaded(Protocol):
    """A program that can be told how many cores to use."""

    def __call__(self, workload: Workload, *, threads: int | None = None) -> Traced:
        """Traces the workload; on all cores without a number."""


#: Those that take a number of cores.
THREADED: dict[str, Threaded] = {"flowtree": trace_flowtree, "numba": trace_numba}

#: All of them; the first of those that run is what the others' results are compared with.
PROGRAMS: dict[str, Program] = {
    "numpy": trace_numpy,
    "numba": trace_numba,
    "hashgrid": trace_hashgrid,
    "flowtree": trace_flowtree,
    "flowtree-1": partial(trace_flowtree, threads=1),
}
if pick_device() != "cpu":
    PROGRAMS["flowtree-cuda"] = partial(trace_flowtree, device=pick_device())
    PROGRAMS["hashgrid-cuda"] = partial(trace_hashgrid, device=pick_device())
