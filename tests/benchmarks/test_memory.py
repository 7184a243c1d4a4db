"""Peaks of memory: each process's own, beside its bound, and a failure is told."""

from __future__ import annotations

import json

import pytest

from benchmarks import memory, programs
from benchmarks.__main__ import run
from benchmarks.memory import Used, measure, peak_mb
from flowtree.errors import InputError


def test_a_process_has_its_own_peak():
    held = bytearray(300_000_000)
    used = measure("use_trace", "numpy", 100)
    assert used.valid
    assert 20.0 < used.before_mb <= used.peak_mb < 2000.0
    assert used.particle_steps is not None
    assert used.particle_steps > 1000
    del held
    assert peak_mb() > 300.0


def test_a_failing_process_is_told():
    with pytest.raises(InputError, match=r"use_trace: must succeed.*KeyError"):
        measure("use_trace", "nobody", 10)


@pytest.mark.parametrize(("peak", "code"), [(900.0, 0), (2100.0, 1)])
def test_prints_peaks_beside_the_bound(tmp_path, monkeypatch, capsys, peak, code):
    monkeypatch.setattr(memory, "measure", lambda work, *_: Used(1.5, 200.0, peak, 77, True))
    monkeypatch.setattr(programs, "PROGRAMS", {"flowtree": None, "numba": None, "numpy": None})
    file = tmp_path / "report.json"
    assert run(["memory", "--json", str(file)]) == code
    said = capsys.readouterr().out
    for line in ("trace.flowtree", "trace.numba", "reconstruct_demo.flowtree"):
        assert f"memory.{line} {peak:.0f} MB, before it began 200 MB" in said
    assert "numpy" not in said.partition("\n")[2]
    assert f"2000 MB: {'no' if code else 'yes'}" in said
    report = json.loads(file.read_text())
    assert report["peak_mb"]["trace.flowtree"] == peak
    assert report["cases"][0]["particle_steps"] == 77


@pytest.mark.parametrize(
    ("arguments", "words"),
    [(["--size", "-1"], "--size: must not be negative"), (["--programs", "nimpy"], "did you mean 'numpy'?")],
)
def test_bad_arguments_get_one_line(capsys, arguments, words):
    assert run(["memory", *arguments]) == 1
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert words in said
