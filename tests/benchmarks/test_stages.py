"""The timing of stages: every stage and the tracing have a line, in one form."""

from __future__ import annotations

import re

import pytest

from benchmarks import stages
from benchmarks.__main__ import run
from flowtree.pipeline.table import STAGES
from tests.pictures import save_pair


def test_prints_case_step_value_unit(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(stages, "_PAIR", list(save_pair(tmp_path)))
    code = run(["stages", "--rounds", "1"])
    *lines, machine = capsys.readouterr().out.splitlines()
    found = dict(re.fullmatch(r"demo\.(\S+) ([\d.]+) s(?: \(.*\))?", line).groups() for line in lines)
    assert [*found][: len(STAGES)] == [stage.name for stage in STAGES]
    traced = [float(found[f"flow.{count}_particles"]) for count in stages.PARTICLES]
    assert code == (0 if max(traced) < stages.TRACE_SECONDS else 1)
    assert sum(float(found[stage.name]) for stage in STAGES) == pytest.approx(float(found["all"]), abs=0.02)
    assert "cores" in machine


def test_no_round_is_refused(capsys):
    assert run(["stages", "--rounds", "0"]) == 1
    assert "--rounds: must be at least 1" in capsys.readouterr().err
