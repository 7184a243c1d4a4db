"""The hot loops' benchmark on small sizes: what its programs compute is compared before it is timed."""

from __future__ import annotations

import json

import pytest

from benchmarks import loops
from benchmarks.__main__ import run
from benchmarks.cases import Case

SMALL = {"sides": (16,), "cells": 10, "branches": 60, "leaves": 80, "size": 24, "things": 900}


@pytest.fixture(scope="module")
def cases() -> list[Case]:
    return loops.time_loops(runs=1, **SMALL)


def test_every_program_is_right_and_timed(cases):
    assert all(case.valid for case in cases), [case for case in cases if not case.valid]
    assert all(case.runs == 1 and case.median_s > 0 for case in cases)


def test_every_kernel_has_its_library(cases):
    programs = {}
    for case in cases:
        programs.setdefault(case.case, set()).add(case.program)
    assert programs.pop("solve_density") == {"flowtree"}
    assert programs == {
        "fit_depths": {"flowtree", "scipy"},
        "direction_field": {"flowtree", "scipy"},
        "sweep_rings": {"flowtree", "numpy"},
        "cast_rays": {"flowtree", "numpy"},
        "choose_cover": {"flowtree", "scipy"},
    }


def test_writes_its_report_and_fails_where_it_is_slow(tmp_path, monkeypatch, cases, capsys):
    monkeypatch.setattr(loops, "time_loops", lambda runs: cases)
    assert run(["loops", "--json", str(tmp_path / "loops.json")]) == 0
    assert len(json.loads((tmp_path / "loops.json").read_text())["cases"]) == len(cases)
    assert "cast_rays.170.numpy" in capsys.readouterr().out
    monkeypatch.setattr(loops, "SOLVE_SECONDS", {16: 0.0})
    assert run(["loops"]) == 1


def test_no_run_is_refused(capsys):
    assert run(["loops", "--runs", "0"]) == 1
    assert "--runs: must be at least 1" in capsys.readouterr().err
