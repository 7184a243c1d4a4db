"""Times tracing on one core, two and so on to all, and the cost of a particle step as particles grow more."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path

from benchmarks.cases import Case, print_cases, time_programs, write_report
from benchmarks.describe_machine import describe_machine
from benchmarks.programs import THREADED
from benchmarks.validate_traced import find_faults
from benchmarks.workload import Traced, Workload, make_workload
from flowtree import check
from flowtree.device import thread_count

CORES_SIZE = 100_000
SIZES = (10_000, 100_000, 1_000_000)

#: What is asked of flowtree: how many times as fast two cores are as one, and how many times as much a
#: particle step may cost at the largest size as at the smallest.
LEAST_OF_TWO, MOST_GROWTH = 1.7, 1.5


def main(argv: list[str]) -> int:
    """Prints medians and ratios; returns 0 where all is right and flowtree keeps to the bounds."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks scaling", description=__doc__)
    parser.add_argument(
        "--cores-size", type=int, default=CORES_SIZE, metavar="N", help="particles on 1.. cores"
    )
    parser.add_argument(
        "--sizes", type=int, nargs="+", default=SIZES, metavar="N", help="particles on all cores"
    )
    parser.add_argument("--runs", type=int, default=5, help="of which the median counts")
    parser.add_argument("--json", type=Path, metavar="FILE", help="the same numbers as a file")
    options = parser.parse_args(argv)
    check.require(options.runs > 0, "--runs", "must be at least 1", options.runs, "give more")
    least = min(*options.sizes, options.cores_size)
    check.require(least > 0, "--sizes, --cores-size", "must be at least 1", least, "give more")
    print(describe_machine())
    cores = range(1, thread_count() + 1)
    on_cores = _time("trace_on_cores", options.cores_size, cores, options.runs)
    growing = [
        case for n in sorted(set(options.sizes)) for case in _time("trace", n, cores[-1:], options.runs)
    ]
    cases = on_cores + growing
    if options.json is not None:
        write_report(cases, options.json)
    kept = [_judge(name, on_cores, growing) for name in THREADED]
    return 0 if all(kept) and all(case.valid for case in cases) else 1


def _time(case: str, size: int, cores: range, runs: int) -> list[Case]:
    """Every program that takes a number of cores, on each number of them."""
    workload = make_workload(size)
    cases = time_programs(
        case,
        size,
        {f"{name}-{n}": _bind(name, workload, n) for name in THREADED for n in cores},
        validate=lambda traced: not find_faults(traced, size),
        runs=runs,
        steps=lambda traced: traced.particle_steps,
    )
    print_cases(cases)
    return cases


def _bind(name: str, workload: Workload, cores: int) -> Callable[[], Traced]:
    return lambda: THREADED[name](workload, threads=cores)


def _judge(name: str, on_cores: list[Case], growing: list[Case]) -> bool:
    """Prints speed-up and growth; whether they are as asked, which goes for flowtree alone."""
    own = {case.program: case.median_s for case in on_cores if case.valid}
    times = {
        n: own[f"{name}-1"] / own[f"{name}-{n}"]
        for n in range(2, len(own) + 1)
        if f"{name}-{n}" in own and f"{name}-1" in own
    }
    for n, ratio in times.items():
        print(f"scaling.{name} {n} cores are {ratio:.2f} times as fast as one")
    costs = [
        case.median_s / case.particle_steps
        for case in growing
        if case.program.rpartition("-")[0] == name and case.valid and case.particle_steps
    ]
    growth = costs[-1] / costs[0] if costs else 1.0
    print(f"scaling.{name} a particle step costs {growth:.2f} times as much at the largest size")
    if name != "flowtree":
        return True
    kept = times.get(2, LEAST_OF_TWO) >= LEAST_OF_TWO and growth <= MOST_GROWTH
    print(
        f"asked: two cores {LEAST_OF_TWO} times, cost at most {MOST_GROWTH} times: {'yes' if kept else 'no'}"
    )
    return kept
