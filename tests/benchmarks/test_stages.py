"""The timing of stages: every stage and the tracing have a line, in one form, and a case in the report."""

from __future__ import annotations

import functools
import re

import pytest

from benchmarks import matted_pair, stages
from benchmarks.__main__ import run
from benchmarks.cases import read_report
from benchmarks.watch_command import Watched
from flowtree.configuration import override_params
from flowtree.params import Params
from flowtree.pipeline.reconstruct import reconstruct
from flowtree.pipeline.table import STAGES
from tests.pictures import save_pair

NAMES = [stage.name for stage in STAGES]


def test_prints_case_step_value_unit(tmp_path, monkeypatch, capsys):
    pair = save_pair(tmp_path)
    small = override_params(Params(), ["flow.particle_count=600", "leaves.most=3000"])
    monkeypatch.setattr(stages, "reconstruct", functools.partial(reconstruct, params=small))
    monkeypatch.setattr(matted_pair, "PAIR", pair)
    monkeypatch.setattr(matted_pair, "save_matted_pair", lambda folder: pair)
    monkeypatch.setattr(stages, "watch_command", lambda arguments: Watched(3.0, 0.9, 0.05))
    code = run(["stages", "--rounds", "1", "--json", str(tmp_path / "stages.json")])
    *lines, machine = capsys.readouterr().out.splitlines()
    rows = [re.fullmatch(r"(given|demo)\.(\S+) ([\d.]+) s(?: \(.*\))?", line).groups() for line in lines]
    for program, more in (("given", [*stages.PROCESS, "process"]), ("demo", [])):
        found = {stage: float(value) for name, stage, value in rows if name == program}
        assert [*found][: len(NAMES)] == NAMES
        assert set(more) <= set(found)
        assert sum(found[name] for name in NAMES) == pytest.approx(found["all"], abs=0.02)
    traced = [found[f"flow.{count}_particles"] for count in stages.PARTICLES]
    assert code == (0 if max(traced) < stages.TRACE_SECONDS else 1)
    assert "cores" in machine
    _, cases = read_report(tmp_path / "stages.json")
    assert [(case.program, case.case) for case in cases] == [(p, f"stage.{stage}") for p, stage, _ in rows]
    assert all(case.valid and case.runs == 1 for case in cases)


def test_no_round_is_refused(capsys):
    assert run(["stages", "--rounds", "0"]) == 1
    assert "--rounds: must be at least 1" in capsys.readouterr().err
