"""Kernels are made ready ahead: those that the table names, which are those that are launched."""

from __future__ import annotations

import os
import subprocess
import sys
from concurrent.futures import Future
from pathlib import Path

import pytest

from flowtree.errors import InputError
from flowtree.params import Params
from flowtree.pipeline import load_kernels as file
from flowtree.pipeline.load_kernels import load_kernels
from flowtree.pipeline.run_stages import run_stages
from flowtree.pipeline.stage import Job, Stage
from flowtree.pipeline.table import STAGES

ROOT = Path(__file__).parents[2]
NAMED = {name for stage in STAGES for name in stage.kernels}

_MAKE = """
import sys, warp
from pathlib import Path
from flowtree.pipeline.reconstruct import reconstruct
from tests.pictures import save_pair

loaded, load = [], warp._src.context.Module.load
def watch(module, *arguments, **options):
    loaded.append(module.name)
    return load(module, *arguments, **options)
warp._src.context.Module.load = watch
made = reconstruct(save_pair(Path(sys.argv[1])), height=6.0)
assert made.tree.foliage is not None
print(*sorted({name.rpartition(".")[2] for name in loaded}))
"""


def _stage(name, *kernels, run=lambda job: 0):
    return Stage(name, run, (), (name,), kernels=kernels)


def test_a_new_machine_compiles_what_the_table_names_and_nothing_else(tmp_path):
    done = subprocess.run(
        [sys.executable, "-c", _MAKE, str(tmp_path)],
        env={**os.environ, "WARP_CACHE_PATH": str(tmp_path / "cache")},
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    compiled = {path.name.split(".")[2].rpartition("_")[0] for path in (tmp_path / "cache").rglob("*.o")}
    assert compiled == NAMED
    assert set(done.stdout.split()) == NAMED, "whatever is launched has been made ready before"


def test_each_module_is_begun_once_in_the_order_of_the_stages(monkeypatch):
    begun = []
    monkeypatch.setattr(
        file, "compile_module", lambda module, device: begun.append((module.__name__, device))
    )
    monkeypatch.setattr(file, "thread_count", lambda: 1)
    with load_kernels((_stage("a", "time_flow", "cell_list"), _stage("b", "cell_list")), "cpu") as waiting:
        assert [job.result() for job in waiting.values()] == [None, None]
    assert begun == [("flowtree.kernels.time_flow", "cpu"), ("flowtree.kernels.cell_list", "cpu")]


def test_without_kernels_nothing_begins():
    with load_kernels((_stage("a"),), "no such device") as waiting:
        assert waiting == {}


def test_an_unknown_device_is_refused():
    with pytest.raises(InputError, match="device"), load_kernels((_stage("a", "cell_list"),), "abacus"):
        pass


def test_a_stage_waits_for_its_own_kernels_alone(monkeypatch):
    """The first stage runs while the second one's kernels are not ready, and that one when they are."""
    ready, seen = Future(), []

    def first(job):
        seen.append("first")
        ready.set_result(None)
        return 0

    monkeypatch.setattr(file, "compile_module", lambda module, device: ready.result(timeout=20))
    stages = (_stage("a", run=first), _stage("b", "cell_list", run=lambda job: seen.append("second")))
    run_stages(stages, {}, Job(Params(), 0, "cpu"), views=1)
    assert seen == ["first", "second"]


def test_what_cannot_be_compiled_ends_the_run(monkeypatch):
    def refuse(module, device):
        raise RuntimeError("no compiler")

    monkeypatch.setattr(file, "compile_module", refuse)
    with pytest.raises(RuntimeError, match="no compiler"):
        run_stages((_stage("a", "cell_list"),), {}, Job(Params(), 0, "cpu"), views=1)
