"""Times the particle kernels against their peers on one workload, and the other hot loops."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from benchmarks.cases import Case, print_cases, time_programs, write_report
from benchmarks.describe_machine import describe_machine
from benchmarks.draw_times import draw_times
from benchmarks.loops import time_loops
from benchmarks.programs import PROGRAMS
from benchmarks.roofline import measure_machine, print_roofline
from benchmarks.validate_traced import compare_traced, find_faults
from benchmarks.workload import Program, Traced, Workload, make_workload
from flowtree import check

SIZES = (1_000, 2_000, 10_000, 100_000, 1_000_000)
PICTURE = "trace.png"

#: Cases of the other hot loops: append a function here that times more of them, so often as it is told.
LOOPS: list[Callable[[int], list[Case]]] = [lambda runs: time_loops(runs=runs)]

_PATIENCE = 20.0  # [s] of timed runs of one program at one size
_LONGEST = 60.0  # [s] of one run: slower programs are left out


@dataclass(frozen=True)
class Asked:
    """How many times as fast as ``peer`` flowtree must be at a size; at any of `SIZES` where it is None."""

    peer: str
    size: int | None
    times: float


#: What is asked of flowtree on all cores.
ASKED = (
    Asked("numba", 2_000, 1.0),
    Asked("numba", 100_000, 1.0),
    Asked("numba", 1_000_000, 1.0),
    Asked("numba", None, 1.5),
    Asked("numpy", 2_000, 10.0),
    Asked("numpy", 100_000, 10.0),
)
_PAPER_SIZE, _PAPER_SECONDS = 2_000, 0.05  # the paper's case; it reports 5 to 10 s


def main(argv: list[str]) -> int:
    """Prints medians and ratios; returns 0 where all results are right and all that is `ASKED` is reached."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks kernels", description=__doc__)
    parser.add_argument("--sizes", type=int, nargs="+", default=SIZES, metavar="N", help="particles")
    parser.add_argument("--runs", type=int, default=5, help="of which the median counts")
    parser.add_argument("--programs", nargs="+", metavar="NAME", help=f"of {', '.join(PROGRAMS)}")
    parser.add_argument("--trace-only", action="store_true", help="leave the other hot loops out")
    parser.add_argument("--json", type=Path, metavar="FILE", help="the same numbers as a file")
    parser.add_argument("-o", "--output", type=Path, metavar="FOLDER", help=f"a plot, {PICTURE}")
    options = parser.parse_args(argv)
    check.require(options.runs > 0, "--runs", "must be at least 1", options.runs, "give more")
    least = min(options.sizes)
    check.require(least >= 0, "--sizes", "must not be negative", least, "give 0 or more")
    programs = choose_programs(options.programs)
    print(describe_machine())
    cases = time_traces(programs, sorted(set(options.sizes)), runs=options.runs)
    reached = _judge(cases)
    _print_floor(cases)
    if not options.trace_only:
        for loop in LOOPS:
            loops = loop(options.runs)
            print_cases(loops)
            cases += loops
    if options.output is not None:
        options.output.mkdir(parents=True, exist_ok=True)
        traces = [case for case in cases if case.case == "trace"]
        draw_times(traces, options.output / PICTURE, title=describe_machine().partition(";")[0])
    if options.json is not None:
        write_report(cases, options.json)
    return 0 if reached and all(case.valid for case in cases) else 1


def choose_programs(names: Sequence[str] | None) -> dict[str, Program]:
    """The named programs, all without names.

    Raises:
        InputError: an unknown name.
    """
    for name in names or ():
        known = name in PROGRAMS
        check.require(known, name, "must be a program", "an unknown name", check.nearest_name(name, PROGRAMS))
    return {name: program for name, program in PROGRAMS.items() if not names or name in names}


def time_traces(programs: Mapping[str, Program], sizes: Sequence[int], *, runs: int) -> list[Case]:
    """The workload at each size, smallest first; says what is left out because a run would take too long.

    The first program's result is validated by itself, and the others' also against it.
    """
    cases: list[Case] = []
    expected: dict[str, float] = {}  # seconds a particle, at the size before
    for size in sizes:
        left_out = [name for name in programs if expected.get(name, 0.0) * size > _LONGEST]
        for name in left_out:
            print(f"trace.{size}.{name} left out: a run would take more than {_LONGEST:g} s")
        run = {name: program for name, program in programs.items() if name not in left_out}
        at_size = _time_size(run, make_workload(size), runs)
        print_cases(at_size)
        expected.update({one.program: one.median_s / max(size, 1) for one in at_size if one.valid})
        cases += at_size
    return cases


def _time_size(programs: Mapping[str, Program], workload: Workload, runs: int) -> list[Case]:
    count = len(workload.start)
    reference: list[Traced] = []

    def validate(name: str, traced: Traced) -> bool:
        faults = find_faults(traced, count)
        for fault in faults:
            print(f"trace.{count}.{name} wrong: {fault}")
        if faults:
            return False
        if not reference:
            reference.append(traced)
            return True
        agreement = compare_traced(traced, reference[0])
        print(f"trace.{count}.{name} beside {first}: {agreement}")
        return agreement.holds

    def bind(name: str, program: Program) -> Callable[[], tuple[str, Traced]]:
        return lambda: (name, program(workload))

    first = next(iter(programs), "")
    return time_programs(
        "trace",
        count,
        {name: bind(name, program) for name, program in programs.items()},
        validate=lambda result: validate(*result),
        runs=runs,
        steps=lambda result: result[1].particle_steps,
        patience=_PATIENCE,
    )


def _judge(cases: Sequence[Case]) -> bool:
    """Prints how many times as fast flowtree is, and whether that is what is asked."""
    seconds = {(case.program, case.size): case.median_s for case in cases if case.valid}
    ratios = {
        (peer, size): theirs / seconds["flowtree", size]
        for (peer, size), theirs in seconds.items()
        if peer != "flowtree" and ("flowtree", size) in seconds
    }
    for (peer, size), ratio in ratios.items():
        print(f"trace.{size}.flowtree {ratio:.2f} times as fast as {peer}")
    reached = True
    for asked in ASKED:
        sizes = SIZES if asked.size is None else (asked.size,)
        own = [ratios[asked.peer, size] for size in sizes if (asked.peer, size) in ratios]
        if own:
            holds = max(own) >= asked.times
            where = "at one size" if asked.size is None else f"at {asked.size}"
            print(f"asked: {asked.times:g} times {asked.peer} {where}: {'yes' if holds else 'no'}")
            reached = reached and holds
    if ("flowtree", _PAPER_SIZE) in seconds:
        holds = seconds["flowtree", _PAPER_SIZE] < _PAPER_SECONDS
        print(f"asked: {_PAPER_SIZE} particles in {_PAPER_SECONDS:g} s: {'yes' if holds else 'no'}")
        reached = reached and holds
    return reached


def _print_floor(cases: Sequence[Case]) -> None:
    """The roofline of flowtree, without it of the fastest, at the largest size."""
    timed = [case for case in cases if case.valid and case.particle_steps]
    if not timed:
        return
    size = max(case.size for case in timed)
    best = min((c for c in timed if c.size == size), key=lambda c: (c.program != "flowtree", c.median_s))
    print_roofline(measure_machine(), best.program, size, best.median_s, best.particle_steps or 0)
