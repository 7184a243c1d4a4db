"""Times the command's start and the demo, with cold and with warm caches, and its peak memory."""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import sysconfig
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from statistics import median
from typing import NamedTuple

from benchmarks.describe_machine import describe_machine
from flowtree import check

#: What each may take: [s], and [MB] for the memory.
BOUNDS = {"help": 0.4, "cold": 25.0, "warm": 8.0, "memory": 1200.0}

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
    """Prints what was measured beside `BOUNDS`; returns 0 where all are kept."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks startup", description=__doc__)
    parser.add_argument("--rounds", type=int, default=5, help="of --help, of which the median counts")
    rounds = parser.parse_args(argv).rounds
    check.require(rounds > 0, "--rounds", "must be at least 1", rounds, "give more")
    found = {"help": median(spend(["--help"]).seconds for _ in range(rounds))}
    with tempfile.TemporaryDirectory(prefix="flowtree-startup-") as folder:
        caches = {name: str(Path(folder) / name.lower()) for name in _CACHES}
        cold = spend(["demo", "-o", f"{folder}/cold"], caches)
        warm = [spend(["demo", "-o", f"{folder}/warm"], caches) for _ in range(3)]
        same = _content(Path(folder) / "cold") == _content(Path(folder) / "warm")
        check.require(same, "demo", "must write the same tree each time", "another", "mend it")
    found["cold"] = cold.seconds
    found["warm"] = median(run.seconds for run in warm)
    found["memory"] = max(run.peak_mb for run in (cold, *warm))
    names = {"help": "flowtree.help", "cold": "demo.cold", "warm": "demo.warm", "memory": "demo.peak_memory"}
    for key, value in found.items():
        unit = "MB" if key == "memory" else "s"
        digits = 0 if key == "memory" else 2
        print(f"{names[key]} {value:.{digits}f} {unit} (asked < {BOUNDS[key]:g})")
    print(describe_machine())
    return 0 if all(found[key] < bound for key, bound in BOUNDS.items()) else 1


def spend(arguments: Sequence[str], environment: Mapping[str, str] | None = None) -> Spent:
    """Runs ``flowtree`` with the arguments, as installed beside this Python.

    Raises:
        InputError: it is not installed, or it failed.
    """
    program = Path(sysconfig.get_path("scripts")) / "flowtree"
    check.require(program.is_file(), str(program), "must be installed", "no file", "pip install -e .")
    done = subprocess.run(
        [sys.executable, "-c", _WATCH, str(program), *arguments],
        env={**os.environ, **(environment or {})},
        capture_output=True,
        check=True,
    )
    code, seconds, peak, said = json.loads(done.stdout)
    check.require(code == 0, f"flowtree {arguments[0]}", "must succeed", said.strip()[-300:], "mend it")
    return Spent(seconds, peak / (1e6 if sys.platform == "darwin" else 1e6 / 1024.0))


def _content(folder: Path) -> bytes:
    return (folder / "tree.glb").read_bytes()
