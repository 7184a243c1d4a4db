"""The one way in which programs are timed here, and the report that ``--json FILE`` writes.

A report is ``{"machine": {…}, "cases": [{"case", "size", "program", "median_s", "min_s", "max_s", "runs",
"particle_steps", "valid"}, …]}``; the times of a case whose result was wrong are null.
"""

from __future__ import annotations

import gc
import json
import math
import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from statistics import median
from typing import Any, TypeVar

from benchmarks.describe_machine import list_machine
from flowtree import check
from flowtree.files import write_whole

T = TypeVar("T")

_REST = 0.05  # [s] before each run, so that none runs into what the one before has left behind


@dataclass(frozen=True)
class Case:
    """One program's times for one case at one size.

    case: what is computed.
    size: how much of it (particles, voxels, rows).
    program: who computes it.
    median_s, min_s, max_s: [s]; NaN where the result was wrong.
    runs: how many the median is of; 0 where the result was wrong.
    particle_steps: how often a particle was moved, where that is the work.
    valid: whether the result was right.
    """

    case: str
    size: int
    program: str
    median_s: float
    min_s: float
    max_s: float
    runs: int
    particle_steps: int | None
    valid: bool


def time_programs(
    case: str,
    size: int,
    programs: Mapping[str, Callable[[], T]],
    *,
    validate: Callable[[T], bool],
    runs: int,
    steps: Callable[[T], int] | None = None,
    patience: float = math.inf,
) -> list[Case]:
    """Times programs that compute the same, in turn in this process.

    Each runs once without being timed (it compiles and fills its caches) and its result is validated; then
    all that were right run in turn, ``runs`` times, so that whatever else the machine does meets all of them.
    No garbage is collected while one runs. The memory of a result is given back outside of its time.

    Args:
        case: what is computed.
        size: how much of it.
        programs: by name; each returns its result.
        validate: whether a result is right; it may print why not.
        runs: how often each is timed.
        steps: reads from a result how often a particle was moved.
        patience: [s] of timed runs after which a program that is slow is timed no more.

    Raises:
        InputError: no run was asked for.
    """
    check.require(runs > 0, "runs", "must be at least 1", runs, "give more")
    valid: dict[str, bool] = {}
    work: dict[str, int | None] = {}
    for name, program in programs.items():
        result = program()
        valid[name] = bool(validate(result))
        work[name] = None if steps is None else int(steps(result))
        del result
    seconds: dict[str, list[float]] = {name: [] for name in programs}
    for _ in range(runs):
        for name, program in programs.items():
            if valid[name] and sum(seconds[name]) < patience:
                seconds[name].append(_time(program))
    return [_sum_up(case, size, name, seconds[name], work[name], valid[name]) for name in programs]


def _time(program: Callable[[], Any]) -> float:
    gc.collect()
    gc.disable()
    # OpenMP's threads, which Numba uses, keep their cores busy for a while after they are done.
    time.sleep(_REST)
    try:
        start = time.perf_counter()
        result = program()
        seconds = time.perf_counter() - start
        del result
    finally:
        gc.enable()
    return seconds


def _sum_up(case: str, size: int, name: str, seconds: list[float], work: int | None, valid: bool) -> Case:
    spread = (median(seconds), min(seconds), max(seconds)) if seconds else (math.nan,) * 3
    return Case(case, size, name, *spread, len(seconds), work, valid)


def print_cases(cases: Iterable[Case]) -> None:
    """A line each: ``case.size.program median s (min to max, runs)``."""
    for one in cases:
        name = f"{one.case}.{one.size}.{one.program}"
        if not one.valid:
            print(f"{name} wrong result, not timed")
            continue
        digits = max(1, 3 - math.floor(math.log10(max(one.median_s, 1e-9)))) - 1  # three figures that count
        spread = f"{one.min_s:.{digits}f} to {one.max_s:.{digits}f}, {one.runs} runs"
        each = (
            f", {1e9 * one.median_s / one.particle_steps:.0f} ns a particle step"
            if one.particle_steps
            else ""
        )
        print(f"{name} {one.median_s:.{digits}f} s ({spread}{each})", flush=True)


def write_report(cases: Iterable[Case], file: Path, **more: Any) -> None:
    """Writes machine and cases as JSON, and what else there is to say under names of its own.

    Raises:
        OutputError: the file could not be written.
    """
    rows = [{k: None if v != v else v for k, v in asdict(case).items()} for case in cases]
    report = {"machine": list_machine(), "cases": rows, **more}
    write_whole(file, (json.dumps(report, indent=1, allow_nan=False) + "\n").encode())


def read_report(file: Path) -> tuple[dict[str, Any], list[Case]]:
    """Machine and cases of a file that `write_report` wrote; what else it holds is left out.

    Raises:
        InputError: no file, not JSON, no report or a case of another form.
    """
    try:
        report = json.loads(file.read_text(encoding="utf-8"))
    except OSError as error:
        check.fail(str(file), "must be a file that can be read", error.strerror, "name a report")
    except ValueError as error:  # no JSON, or no text
        check.fail(str(file), "must be JSON", str(error), "name a file that --json wrote")
    machine, rows = (report.get(name) if isinstance(report, dict) else None for name in ("machine", "cases"))
    if not (isinstance(machine, dict) and isinstance(rows, list)):
        remedy = "name a file that --json wrote"
        check.fail(str(file), 'must hold {"machine": {…}, "cases": […]}', "something else", remedy)
    return machine, [_read_case(row, f"{file}, case {number}") for number, row in enumerate(rows)]


_KINDS: dict[str, tuple[type, ...]] = {
    "str": (str,),
    "int": (int,),
    "float": (int, float, type(None)),
    "int | None": (int, type(None)),
    "bool": (bool,),
}


def _read_case(row: Any, thing: str) -> Case:
    check.require(isinstance(row, dict), thing, "must be an object", type(row).__name__, "write it anew")
    values: dict[str, Any] = {}
    for field in fields(Case):
        value = row.get(field.name)
        kinds = _KINDS[str(field.type)]
        fits = (
            field.name in row and isinstance(value, kinds) and (isinstance(value, bool) == (kinds == (bool,)))
        )
        check.require(fits, thing, f"{field.name!r} must be {field.type}", repr(value), "write it anew")
        values[field.name] = math.nan if value is None and field.type == "float" else value
    return Case(**values)
