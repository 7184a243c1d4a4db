"""The timing of the command: what a child took is its own, and its failure is told."""

from __future__ import annotations

import pytest

from benchmarks import startup
from benchmarks.__main__ import run
from benchmarks.startup import Spent, spend
from flowtree.errors import InputError


def test_a_command_takes_time_and_memory():
    spent = spend(["--version"])
    assert 0.01 < spent.seconds < 60.0
    assert 5.0 < spent.peak_mb < 500.0, "the child's own memory, not that of the tests"


def test_a_failing_command_says_why():
    with pytest.raises(InputError, match=r"flowtree inspect: must succeed.*nothing\.glb"):
        spend(["inspect", "nothing.glb"])


@pytest.mark.parametrize(("peak", "code"), [(900.0, 0), (1300.0, 1)])
def test_prints_everything_beside_its_bound(monkeypatch, capsys, peak, code):
    ran = []

    def pretend(arguments, environment=None):
        ran.append((arguments[0], set(environment or ())))
        return Spent(0.2 if arguments == ["--help"] else 5.0, peak)

    monkeypatch.setattr(startup, "spend", pretend)
    monkeypatch.setattr(startup, "_content", lambda folder: b"tree")
    assert run(["startup"]) == code
    said = capsys.readouterr().out
    for line in ("flowtree.help 0.20 s", "demo.cold 5.00 s", "demo.warm 5.00 s", "demo.peak_memory"):
        assert line in said
    assert ran.count(("--help", set())) == 5
    assert ran[-1] == ("demo", {"WARP_CACHE_PATH", "NUMBA_CACHE_DIR"})
