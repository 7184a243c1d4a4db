"""The timing of the command: what a child took is its own, and its failure is told."""

from __future__ import annotations

import re

import pytest

from benchmarks import matted_pair, startup
from benchmarks.__main__ import run
from benchmarks.cases import read_report
from benchmarks.startup import Spent, spend
from benchmarks.watch_command import Watched
from flowtree.errors import InputError


def test_a_command_takes_time_and_memory():
    spent = spend(["--version"])
    assert 0.01 < spent.seconds < 60.0
    assert 5.0 < spent.peak_mb < 500.0, "the child's own memory, not that of the tests"


def test_a_failing_command_says_why():
    with pytest.raises(InputError, match=r"flowtree inspect: must succeed.*nothing\.glb"):
        spend(["inspect", "nothing.glb"])


@pytest.mark.parametrize(("peak", "begin", "code"), [(900.0, 0.8, 0), (1300.0, 0.8, 1), (900.0, 1.1, 1)])
def test_prints_everything_beside_its_bound(tmp_path, monkeypatch, capsys, peak, begin, code):
    ran = []

    def pretend(arguments, environment=None):
        ran.append((arguments[0], set(environment or ())))
        return Spent(0.2 if arguments == ["--help"] else 5.0, peak)

    def watch(arguments, environment):
        ran.append((arguments[0], set(environment)))
        return Watched(2.5, begin, 0.05)

    monkeypatch.setattr(startup, "spend", pretend)
    monkeypatch.setattr(startup, "watch_command", watch)
    monkeypatch.setattr(startup, "_content", lambda file: b"tree")
    monkeypatch.setattr(matted_pair, "save_matted_pair", lambda folder: (folder / "a.png", folder / "b.png"))
    assert run(["startup", "--json", str(tmp_path / "startup.json")]) == code
    said = capsys.readouterr().out
    for key in startup.BOUNDS:
        assert re.search(rf"^{re.escape(key)} [\d.]+ (s|MB) \(asked < [\d.]+\)$", said, re.MULTILINE)
    caches = {"WARP_CACHE_PATH", "NUMBA_CACHE_DIR"}
    assert [ran.count(each) for each in (("--help", set()), ("demo", caches), ("reconstruct", caches))] == [
        5,
        4,
        5,
    ]
    _, cases = read_report(tmp_path / "startup.json")
    medians = {case.case: case.median_s for case in cases}
    assert medians["reconstruct.mattes_given.warm"] == 2.5
    assert medians["reconstruct.mattes_given.start_and_imports"] == begin
    assert not any("memory" in name for name in medians), "a report holds seconds"
