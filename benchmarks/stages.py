"""Times every stage of the demo, warm, and the tracing of few particles."""

from __future__ import annotations

import argparse
import time
from pathlib import Path
from statistics import median

from benchmarks.describe_machine import describe_machine
from flowtree import check
from flowtree.flow.trace_particles import trace_particles
from flowtree.params import FlowParams
from flowtree.pipeline.reconstruct import Reconstruction, reconstruct

#: Particles as in the paper, and what tracing them may take [s].
PARTICLES, TRACE_SECONDS = (1000, 2000), 0.3

_PAIR = [Path(__file__).parents[1] / "flowtree" / "cli" / "demo" / f"photo_{k}.jpg" for k in (0, 1)]
_HEIGHT = 11.0  # [m]


def main(argv: list[str]) -> int:
    """Prints medians [s]; returns 0 where tracing keeps to `TRACE_SECONDS`."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks stages", description=__doc__)
    parser.add_argument("--rounds", type=int, default=3, help="of which the median counts")
    rounds = parser.parse_args(argv).rounds
    check.require(rounds > 0, "--rounds", "must be at least 1", rounds, "give more")
    made = _make()  # compiles kernels, fills caches
    runs = [_make() for _ in range(rounds)]
    for run in runs:
        check.require(_same(run, made), "demo", "must come out the same each time", "another tree", "mend it")
    for stage in made.report["seconds"]:
        print(f"demo.{stage} {median(run.report['seconds'][stage] for run in runs):.3f} s")
    print(f"demo.all {median(sum(run.report['seconds'].values()) for run in runs):.3f} s")
    traced = {count: _trace(made, count, rounds) for count in PARTICLES}
    for count, seconds in traced.items():
        print(f"demo.flow.{count}_particles {seconds:.3f} s (asked < {TRACE_SECONDS:g})")
    print(describe_machine())
    return 0 if max(traced.values()) < TRACE_SECONDS else 1


def _make() -> Reconstruction:
    return reconstruct(_PAIR, yaws=(0.0, 90.0), height=_HEIGHT)


def _same(one: Reconstruction, other: Reconstruction) -> bool:
    return one.tree.wood.positions.tobytes() == other.tree.wood.positions.tobytes()


def _trace(made: Reconstruction, count: int, rounds: int) -> float:
    """Median seconds; all particles must have arrived."""
    params, seconds = FlowParams(particle_count=count), []
    for _ in range(rounds + 1):  # the first only warms up
        start = time.perf_counter()
        traces = trace_particles(made.volume, made.fields, params=params)
        seconds.append(time.perf_counter() - start)
        arrived = int(traces.particles[0])
        check.require(arrived == count, "flow", f"must bring {count} particles down", arrived, "mend it")
    return median(seconds[1:])
