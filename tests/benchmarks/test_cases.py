"""The harness: programs run in turn, wrong results are not timed, and reports come back as they were."""

from __future__ import annotations

import dataclasses
import json
import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks.cases import Case, print_cases, read_report, time_programs, write_report
from flowtree.errors import InputError

_NAMES = ["case", "size", "program", "median_s", "min_s", "max_s", "runs", "particle_steps", "valid"]


def test_warms_up_validates_and_runs_in_turn():
    order = []

    def program(name, result):
        def run():
            order.append(name)
            return result

        return run

    programs = {name: program(name, value) for name, value in {"a": 1, "b": 2, "wrong": -1}.items()}
    cases = time_programs(
        "sum", 7, programs, validate=lambda value: value > 0, runs=3, steps=lambda v: 10 * v
    )
    assert order == ["a", "b", "wrong", *["a", "b"] * 3]
    assert [(case.program, case.valid, case.runs, case.particle_steps) for case in cases] == [
        ("a", True, 3, 10),
        ("b", True, 3, 20),
        ("wrong", False, 0, -10),
    ]
    for case in cases[:2]:
        assert 0 <= case.min_s <= case.median_s <= case.max_s < 1
    assert math.isnan(cases[2].median_s)


def test_no_run_is_refused():
    with pytest.raises(InputError, match="runs: must be at least 1"):
        time_programs("sum", 7, {}, validate=bool, runs=0)


def test_prints_a_line_each(capsys):
    print_cases(
        [
            Case("trace", 2000, "numba", 0.0312, 0.03, 0.0333, 5, 100_000, True),
            Case("trace", 2000, "numpy", *[math.nan] * 3, 0, None, False),
            Case("solve", 64, "library", 12.3456, 11.0, 13.0, 3, None, True),
        ]
    )
    assert capsys.readouterr().out.splitlines() == [
        "trace.2000.numba 0.0312 s (0.0300 to 0.0333, 5 runs, 312 ns a particle step)",
        "trace.2000.numpy wrong result, not timed",
        "solve.64.library 12.3 s (11.0 to 13.0, 3 runs)",
    ]


def test_a_report_has_machine_and_cases_in_one_form(tmp_path):
    file = tmp_path / "report.json"
    write_report([Case("trace", 10, "numpy", *[math.nan] * 3, 0, None, False)], file)
    report = json.loads(file.read_text())
    assert [*report] == ["machine", "cases"]
    assert [*report["cases"][0]] == _NAMES
    assert report["cases"][0]["median_s"] is None, "JSON has no NaN"
    machine = report["machine"]
    assert {"processor", "cores_used", "cores", "memory_gb", "device", "date"} <= {*machine}
    assert {*machine["versions"]} == {"python", "numpy", "scipy", "numba", "warp"}
    again = read_report(file)[1][0]
    assert dataclasses.replace(again, median_s=0.0, min_s=0.0, max_s=0.0) == Case(
        "trace", 10, "numpy", 0.0, 0.0, 0.0, 0, None, False
    )


_SECONDS = st.floats(0, 1e6)
_CASES = st.builds(
    Case,
    case=st.text(max_size=8),
    size=st.integers(0, 10**9),
    program=st.text(max_size=8),
    median_s=_SECONDS,
    min_s=_SECONDS,
    max_s=_SECONDS,
    runs=st.integers(0, 100),
    particle_steps=st.none() | st.integers(0, 10**12),
    valid=st.booleans(),
)


@settings(deadline=None, max_examples=25)
@given(cases=st.lists(_CASES, max_size=4))
def test_reports_come_back_as_they_were(tmp_path_factory, cases):
    file = tmp_path_factory.mktemp("report") / "report.json"
    write_report(cases, file)
    assert read_report(file)[1] == cases


@pytest.mark.parametrize(
    ("name", "value"), [("size", "many"), ("valid", 1), ("runs", True), ("median_s", "1")]
)
def test_a_case_of_another_form_is_refused(tmp_path, name, value):
    file = tmp_path / "report.json"
    write_report([Case("trace", 10, "numpy", 1.0, 1.0, 1.0, 1, None, True)], file)
    report = json.loads(file.read_text())
    report["cases"][0][name] = value
    file.write_text(json.dumps(report))
    with pytest.raises(InputError, match=rf"case 0: '{name}' must be"):
        read_report(file)
    del report["cases"][0][name]
    file.write_text(json.dumps(report))
    with pytest.raises(InputError, match=rf"case 0: '{name}' must be"):
        read_report(file)
