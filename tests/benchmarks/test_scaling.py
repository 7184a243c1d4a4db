"""Cores and growth: every number of cores is timed, and the bounds are those of flowtree alone."""

from __future__ import annotations

import json

import pytest

from benchmarks import scaling
from benchmarks.__main__ import run
from benchmarks.cases import Case
from benchmarks.programs import THREADED
from flowtree.device import thread_count


def test_times_every_number_of_cores_and_every_size(tmp_path, capsys):
    file = tmp_path / "report.json"
    arguments = ["--cores-size", "30", "--sizes", "40", "20", "--runs", "1", "--json", str(file)]
    run(["scaling", *arguments])
    said = capsys.readouterr().out
    cores = range(1, thread_count() + 1)
    expected = [(30, f"{name}-{n}") for name in THREADED for n in cores]
    expected += [(size, f"{name}-{cores[-1]}") for size in (20, 40) for name in THREADED]
    cases = json.loads(file.read_text())["cases"]
    assert [(case["size"], case["program"]) for case in cases] == expected
    assert all(case["valid"] for case in cases)
    for name in THREADED:
        assert f"scaling.{name} a particle step costs" in said


def _case(name: str, seconds: float, size: int = 1000) -> Case:
    return Case("trace", size, name, seconds, seconds, seconds, 1, size, True)


@pytest.mark.parametrize(
    ("name", "two", "large", "kept"),
    [
        ("flowtree", 0.5, 12.0, True),
        ("flowtree", 0.7, 12.0, False),
        ("flowtree", 0.5, 16.0, False),
        ("numba", 0.9, 90.0, True),
    ],
)
def test_flowtree_is_held_to_the_bounds(capsys, name, two, large, kept):
    on_cores = [_case(f"{name}-1", 1.0), _case(f"{name}-2", two)]
    growing = [_case(f"{name}-2", 1.0), _case(f"{name}-2", large, 10_000)]
    assert scaling._judge(name, on_cores, growing) == kept
    said = capsys.readouterr().out
    assert f"2 cores are {1 / two:.2f} times" in said
    assert f"costs {large / 10:.2f} times" in said


@pytest.mark.parametrize("arguments", [["--runs", "0"], ["--sizes", "0"], ["--cores-size", "0"]])
def test_bad_arguments_get_one_line(capsys, arguments):
    assert run(["scaling", *arguments]) == 1
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert "must be at least 1" in said
