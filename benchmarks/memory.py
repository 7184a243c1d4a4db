"""Measures the peak memory of tracing with full records and of making the demo's tree."""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import time
from pathlib import Path
from typing import NamedTuple

from benchmarks.cases import Case, write_report
from benchmarks.describe_machine import describe_machine
from flowtree import check

SIZE = 1_000_000
PROGRAMS = ("flowtree", "numba")  # that are measured where there are no others named

#: What flowtree may have at its peak for tracing `SIZE` particles, with all that Python needs besides [MB].
TRACE_BOUND = 2000.0

_ROOT = Path(__file__).parents[1]
_TREE_HEIGHT = 11.0  # [m], of the demo's tree


class Used(NamedTuple):
    """What a process took.

    seconds: of the work itself [s].
    before_mb, peak_mb: its peak before the work began and at its end [MB].
    particle_steps: None for work without any.
    valid: whether the result was right.
    """

    seconds: float
    before_mb: float
    peak_mb: float
    particle_steps: int | None
    valid: bool


def main(argv: list[str]) -> int:
    """Prints peaks; returns 0 where all is right and flowtree keeps to `TRACE_BOUND`."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks memory", description=__doc__)
    parser.add_argument("--size", type=int, default=SIZE, metavar="N", help="particles")
    parser.add_argument("--programs", nargs="+", metavar="NAME", help="that trace them")
    parser.add_argument("--trace-only", action="store_true", help="leave the demo's tree out")
    parser.add_argument("--json", type=Path, metavar="FILE", help="the same numbers as a file")
    options = parser.parse_args(argv)
    check.require(options.size >= 0, "--size", "must not be negative", options.size, "give 0 or more")
    print(describe_machine())
    used = {("trace", name): measure("use_trace", name, options.size) for name in _choose(options.programs)}
    if not options.trace_only:
        used["reconstruct_demo", "flowtree"] = measure("use_reconstruct")
    for (case, name), one in used.items():
        print(f"memory.{case}.{name} {one.peak_mb:.0f} MB, before it began {one.before_mb:.0f} MB")
    if options.json is not None:
        sizes = {"trace": options.size, "reconstruct_demo": 2}
        cases = [
            Case(
                case,
                sizes[case],
                name,
                one.seconds,
                one.seconds,
                one.seconds,
                1,
                one.particle_steps,
                one.valid,
            )
            for (case, name), one in used.items()
        ]
        peaks = {f"{case}.{name}": round(one.peak_mb, 1) for (case, name), one in used.items()}
        write_report(cases, options.json, peak_mb=peaks)
    own = used.get(("trace", "flowtree"))
    kept = own is None or options.size > SIZE or own.peak_mb < TRACE_BOUND
    if own is not None:
        print(f"asked: {SIZE} particles in less than {TRACE_BOUND:g} MB: {'yes' if kept else 'no'}")
    return 0 if kept and all(one.valid for one in used.values()) else 1


def measure(work: str, *arguments: object) -> Used:
    """Runs one of the functions ``use_…`` of this file in a process of its own.

    Raises:
        InputError: it failed.
    """
    words = ", ".join(map(repr, arguments))
    code = f"from benchmarks import memory; memory.{work}({words})"
    paths = [str(_ROOT), *filter(None, [os.environ.get("PYTHONPATH")])]
    done = subprocess.run(
        [sys.executable, "-c", code],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(paths)},
        capture_output=True,
        text=True,
        check=False,
    )
    check.require(done.returncode == 0, work, "must succeed", done.stderr.strip()[-300:], "mend it")
    return Used(*json.loads(done.stdout.splitlines()[-1]))


def use_trace(name: str, size: int) -> None:
    """Traces the workload and prints what that took, as JSON."""
    from benchmarks.programs import PROGRAMS
    from benchmarks.validate_traced import find_faults
    from benchmarks.workload import make_workload

    PROGRAMS[name](make_workload(50))  # compiles, where that was not kept
    workload = make_workload(size)
    before, start = peak_mb(), time.perf_counter()
    traced = PROGRAMS[name](workload)
    seconds, peak = time.perf_counter() - start, peak_mb()
    print(json.dumps(Used(seconds, before, peak, traced.particle_steps, not find_faults(traced, size))))


def use_reconstruct() -> None:
    """Makes the demo's tree and prints what that took, as JSON."""
    from flowtree.pipeline.reconstruct import reconstruct

    folder = _ROOT / "flowtree" / "cli" / "demo"
    before, start = peak_mb(), time.perf_counter()
    made = reconstruct([folder / f"photo_{k}.jpg" for k in (0, 1)], yaws=(0.0, 90.0), height=_TREE_HEIGHT)
    seconds, peak = time.perf_counter() - start, peak_mb()
    print(json.dumps(Used(seconds, before, peak, None, bool(made.report["mesh"]["watertight"]))))


def peak_mb() -> float:
    """This process's peak [MB]; on Linux without what its parent had held until it was started."""
    try:
        lines = Path("/proc/self/status").read_text(encoding="utf-8").splitlines()
        return next(int(line.split()[1]) for line in lines if line.startswith("VmHWM:")) * 1024e-6
    except (OSError, StopIteration):
        import resource

        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        return peak / (1e6 if sys.platform == "darwin" else 1e6 / 1024.0)


def _choose(names: list[str] | None) -> list[str]:
    """The programs to measure: the named ones, else those of `PROGRAMS` that there are."""
    from benchmarks import programs

    known = programs.PROGRAMS
    for name in names or ():
        check.require(name in known, name, "must be a program", "another", check.nearest_name(name, known))
    return names or [name for name in PROGRAMS if name in known]
