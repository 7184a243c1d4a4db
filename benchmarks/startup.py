"""Times the command's start, the demo and a reconstruction, cold and warm, and the demo's peak memory."""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from statistics import median
from typing import NamedTuple

from benchmarks import matted_pair
from benchmarks.cases import Case, write_report
from benchmarks.describe_machine import describe_machine
from benchmarks.watch_command import find_program, watch_command
from flowtree import check

#: What each may take: [s], and [MB] for the memory.
BOUNDS = {
    "flowtree.help": 0.4,
    "demo.cold": 25.0,
    "demo.warm": 8.0,
    "demo.peak_memory": 1200.0,
    "reconstruct.mattes_given.warm": 3.0,
    "reconstruct.mattes_given.start_and_imports": 1.0,
}

# What compiled code is kept by: Warp's kernels, and the loops that pymatting leaves to Numba.
_CACHES = ("WARP_CACHE_PATH", "NUMBA_CACHE_DIR")

# A process counts what its parent held until it was started to its own peak: the one that starts the command
# must be small.
_WATCH = """
import json, resource, subprocess, sys, time
start = time.perf_counter()
done = subprocess.run(sys.argv[1:], stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
seconds = time.perf_counter() - start
peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
print(json.dumps([done.returncode, seconds, peak, done.stdout.decode(errors="replace")]))
"""


class Spent(NamedTuple):
    """What a command took."""

    seconds: float
    peak_mb: float


def main(argv: list[str]) -> int:
    """Prints medians beside `BOUNDS`; returns 0 where all are kept."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks startup", description=__doc__)
    parser.add_argument("--rounds", type=int, default=5, help="of warm runs, of which the median counts")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write machine and times there")
    options = parser.parse_args(argv)
    rounds = options.rounds
    check.require(rounds > 0, "--rounds", "must be at least 1", rounds, "give more")
    found = {"flowtree.help": [spend(["--help"]).seconds for _ in range(rounds)]}
    with tempfile.TemporaryDirectory(prefix="flowtree-startup-") as name:
        folder = Path(name)
        caches = {name: str(folder / name.lower()) for name in _CACHES}
        cold = spend(["demo", "-o", str(folder / "cold")], caches)
        warm = [spend(["demo", "-o", str(folder / "warm")], caches) for _ in range(min(rounds, 3))]
        same = _content(folder / "cold" / "tree.glb") == _content(folder / "warm" / "tree.glb")
        check.require(same, "demo", "must write the same tree each time", "another", "mend it")
        found["demo.cold"] = [cold.seconds]
        found["demo.warm"] = [run.seconds for run in warm]
        found["demo.peak_memory"] = [max(run.peak_mb for run in (cold, *warm))]
        photos = [str(file) for file in matted_pair.save_matted_pair(folder)]
        made = ["reconstruct", *photos, "--height", str(matted_pair.HEIGHT), "-o", str(folder / "tree.glb")]
        runs = [watch_command(made, caches) for _ in range(rounds)]
        found["reconstruct.mattes_given.warm"] = [run.whole for run in runs]
        found["reconstruct.mattes_given.start_and_imports"] = [run.begin for run in runs]
        found["reconstruct.mattes_given.exit"] = [run.end for run in runs]
    for key, values in found.items():
        unit, digits = ("MB", 0) if key.endswith("memory") else ("s", 2)
        asked = f" (asked < {BOUNDS[key]:g})" if key in BOUNDS else ""
        print(f"{key} {median(values):.{digits}f} {unit}{asked}")
    print(describe_machine())
    if options.json is not None:
        write_report(_cases(found), options.json)
    return 0 if all(median(found[key]) < bound for key, bound in BOUNDS.items()) else 1


def _cases(found: Mapping[str, Sequence[float]]) -> list[Case]:
    """The times among what was found; a case's size is the number of its photos."""
    return [
        Case(key, 0 if "help" in key else 2, "flowtree", median(s), min(s), max(s), len(s), None, True)
        for key, s in found.items()
        if not key.endswith("memory")
    ]


def spend(arguments: Sequence[str], environment: Mapping[str, str] | None = None) -> Spent:
    """Runs ``flowtree`` with the arguments, as installed beside this Python.

    Raises:
        InputError: it is not installed, or it failed.
    """
    done = subprocess.run(
        [sys.executable, "-c", _WATCH, str(find_program()), *arguments],
        env={**os.environ, **(environment or {})},
        capture_output=True,
        check=True,
    )
    code, seconds, peak, said = json.loads(done.stdout)
    check.require(code == 0, f"flowtree {arguments[0]}", "must succeed", said.strip()[-300:], "mend it")
    return Spent(seconds, peak / (1e6 if sys.platform == "darwin" else 1e6 / 1024.0))


def _content(file: Path) -> bytes:
    return file.read_bytes()
