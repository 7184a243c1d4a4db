"""Times every stage, warm, with mattes given and of the demo, what a process adds, and the tracing of few."""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from statistics import median

from benchmarks import matted_pair
from benchmarks.cases import Case, write_report
from benchmarks.describe_machine import describe_machine
from benchmarks.watch_command import watch_command
from flowtree import check
from flowtree.flow.trace_particles import trace_particles
from flowtree.params import FlowParams
from flowtree.pipeline.reconstruct import Reconstruction, reconstruct

#: Particles as in the paper, and what tracing them may take [s].
PARTICLES, TRACE_SECONDS = (1000, 2000), 0.3
#: What a process adds to its stages: Python's start, its imports, and its end.
PROCESS = ("python", "imports", "exit")


def main(argv: list[str]) -> int:
    """Prints medians [s]; returns 0 where tracing keeps to `TRACE_SECONDS`."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks stages", description=__doc__)
    parser.add_argument("--rounds", type=int, default=3, help="of which the median counts")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write machine and cases there")
    options = parser.parse_args(argv)
    rounds = options.rounds
    check.require(rounds > 0, "--rounds", "must be at least 1", rounds, "give more")
    with tempfile.TemporaryDirectory(prefix="flowtree-stages-") as folder:
        pairs = {"given": matted_pair.save_matted_pair(Path(folder)), "demo": matted_pair.PAIR}
        first = {name: _make(pair) for name, pair in pairs.items()}  # compiles kernels, fills caches
        seconds: dict[str, dict[str, list[float]]] = {name: {} for name in pairs}
        for _ in range(rounds):
            for name, pair in pairs.items():
                made = _make(pair)
                check.require(
                    _same(made, first[name]), name, "must come out the same each time", "another", "mend it"
                )
                _add(seconds[name], {**made.report["seconds"], "all": sum(made.report["seconds"].values())})
        for _ in range(rounds):
            _add(seconds["given"], _time_process(pairs["given"], Path(folder)))
    found = first["demo"]
    for count in PARTICLES:
        seconds["demo"][f"flow.{count}_particles"] = _trace(found, count, rounds)
    for name, stages in seconds.items():
        for stage, times in stages.items():
            asked = f" (asked < {TRACE_SECONDS:g})" if stage.startswith("flow.") else ""
            print(f"{name}.{stage} {median(times):.3f} s{asked}")
    print(describe_machine())
    if options.json is not None:
        write_report(_cases(seconds), options.json)
    slowest = max(median(seconds["demo"][f"flow.{count}_particles"]) for count in PARTICLES)
    return 0 if slowest < TRACE_SECONDS else 1


def _make(pair: Sequence[Path]) -> Reconstruction:
    return reconstruct(pair, yaws=(0.0, 90.0), height=matted_pair.HEIGHT)


def _same(one: Reconstruction, other: Reconstruction) -> bool:
    return one.tree.wood.positions.tobytes() == other.tree.wood.positions.tobytes()


def _add(lists: dict[str, list[float]], seconds: Mapping[str, float]) -> None:
    for name, value in seconds.items():
        lists.setdefault(name, []).append(value)


def _time_process(pair: Sequence[Path], folder: Path) -> dict[str, float]:
    """What a whole process of ``flowtree reconstruct`` adds: see `PROCESS`; and ``process``, all of it."""
    start = time.perf_counter()
    subprocess.run([sys.executable, "-c", "pass"], check=True)
    python = time.perf_counter() - start
    run = watch_command(
        ["reconstruct", *map(str, pair), "--height", str(matted_pair.HEIGHT), "-o", str(folder / "tree.glb")]
    )
    return {"python": python, "imports": run.begin - python, "exit": run.end, "process": run.whole}


def _trace(made: Reconstruction, count: int, rounds: int) -> list[float]:
    """Seconds of each round; all particles must have arrived."""
    params, seconds = FlowParams(particle_count=count), []
    for _ in range(rounds + 1):  # the first only warms up
        start = time.perf_counter()
        traces = trace_particles(made.volume, made.fields, params=params)
        seconds.append(time.perf_counter() - start)
        arrived = int(traces.particles[0])
        check.require(arrived == count, "flow", f"must bring {count} particles down", arrived, "mend it")
    return seconds[1:]


def _cases(seconds: Mapping[str, Mapping[str, Sequence[float]]]) -> list[Case]:
    return [
        Case(f"stage.{stage}", 2, name, median(times), min(times), max(times), len(times), None, True)
        for name, stages in seconds.items()
        for stage, times in stages.items()
    ]
