"""The timing of the particle kernels: every program and size, what is asked, the plot, and bad arguments."""

from __future__ import annotations

import dataclasses
import json
import re

import pytest
from PIL import Image

from benchmarks import kernels
from benchmarks.__main__ import run
from benchmarks.cases import Case
from benchmarks.draw_times import draw_times
from benchmarks.programs import PROGRAMS
from benchmarks.roofline import BYTES, OPERATIONS, Machine
from flowtree.errors import InputError

_MACHINE = Machine(bandwidth=BYTES * 1e9, rate=OPERATIONS * 2e9, look_ups=3e-9)


@pytest.fixture(autouse=True)
def _known_machine(monkeypatch):
    monkeypatch.setattr(kernels, "measure_machine", lambda: _MACHINE)


def _time(name: str, seconds: float, size: int = 2_000) -> Case:
    return Case("trace", size, name, seconds, 0.9 * seconds, 1.1 * seconds, 5, 100 * size, True)


def test_times_all_programs_and_writes_numbers_and_plot(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(kernels, "LOOPS", [lambda runs: [_time("library", 1.0), _time("kernel", 0.5)][:runs]])
    file, folder = tmp_path / "report.json", tmp_path / "pictures"
    arguments = ["--sizes", "60", "20", "--runs", "2", "--json", str(file), "-o", str(folder)]
    assert run(["kernels", *arguments]) == 0
    said = capsys.readouterr().out
    cases = json.loads(file.read_text())["cases"]
    assert [(case["size"], case["program"]) for case in cases[:-2]] == [
        (size, name) for size in (20, 60) for name in PROGRAMS
    ]
    assert [case["program"] for case in cases[-2:]] == ["library", "kernel"]
    for case in cases[:-2]:
        assert case["valid"]
        assert case["particle_steps"] > 20 * case["size"]
        assert re.search(rf"^trace\.{case['size']}\.{case['program']} [\d.]+ s", said, re.MULTILINE)
    assert "cores" in said
    assert "roofline.60.floor" in said
    with Image.open(folder / kernels.PICTURE) as picture:
        assert picture.width > picture.height > 500
        assert len(picture.convert("RGB").getcolors(1 << 20)) > 50


def test_a_wrong_result_is_a_failure(monkeypatch, capsys):
    def wrong(workload):
        traced = PROGRAMS["numpy"](workload)
        return dataclasses.replace(traced, arrived=traced.arrived + 1)

    def other(workload):
        return PROGRAMS["numpy"](dataclasses.replace(workload, threshold=3 * workload.threshold))

    programs = {"numpy": PROGRAMS["numpy"], "wrong": wrong, "other": other}
    cases = kernels.time_traces(programs, [60], runs=1)
    assert [case.valid for case in cases] == [True, False, False]
    said = capsys.readouterr().out
    assert "trace.60.wrong wrong: " in said
    assert "trace.60.other wrong result, not timed" in said
    monkeypatch.setattr(kernels, "PROGRAMS", programs)
    assert run(["kernels", "--sizes", "60", "--runs", "1", "--trace-only"]) == 1


def test_slow_programs_are_left_out_and_it_is_said(monkeypatch, capsys):
    monkeypatch.setattr(kernels, "_LONGEST", 1e-9)
    cases = kernels.time_traces({"numpy": PROGRAMS["numpy"]}, [5, 6], runs=1)
    assert [case.size for case in cases] == [5]
    assert "trace.6.numpy left out" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("times", "reached"),
    [
        ({"numba": 0.02, "numpy": 0.2}, True),
        ({"numba": 0.0099, "numpy": 0.2}, False),
        ({"numba": 0.014, "numpy": 0.2}, False),
        ({"numba": 0.02, "numpy": 0.09}, False),
        ({}, True),
    ],
)
def test_says_what_is_asked_and_whether_it_is_reached(capsys, times, reached):
    cases = [_time("flowtree", 0.01), *(_time(name, seconds) for name, seconds in times.items())]
    assert kernels._judge(cases) == reached
    said = capsys.readouterr().out
    assert ("no" in [line.rpartition(" ")[2] for line in said.splitlines()]) == (not reached)
    assert "asked: 2000 particles in 0.05 s: yes" in said


def test_without_flowtree_nothing_is_asked(capsys):
    assert kernels._judge([_time("numba", 1.0)])
    assert capsys.readouterr().out == ""


def test_the_floor_is_the_larger_of_bytes_and_operations():
    assert _MACHINE.floor(10**9) == pytest.approx(1.0)
    assert _MACHINE._replace(rate=OPERATIONS * 1e8).floor(10**9) == pytest.approx(10.0)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--runs", "0"], "--runs: must be at least 1"),
        (["--sizes", "-3"], "--sizes: must not be negative"),
        (["--programs", "nimba"], "did you mean 'numba'?"),
    ],
)
def test_bad_arguments_get_one_line(capsys, arguments, words):
    assert run(["kernels", *arguments]) == 1
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert words in said


def test_nothing_to_draw_is_refused(tmp_path):
    wrong = Case("trace", 10, "numba", *[float("nan")] * 3, 0, None, False)
    with pytest.raises(InputError, match="needs a time to draw"):
        draw_times([wrong], tmp_path / "a.png", title="none")
    assert not (tmp_path / "a.png").exists()
