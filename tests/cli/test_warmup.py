"""Compiling ahead: everything once, where it is kept, and nothing at import."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import sysconfig
import time
from pathlib import Path

import pytest

from flowtree.cli.warmup import kernel_modules

ROOT = Path(__file__).parents[2]
FILES = sorted(path.stem for path in (ROOT / "kernels").glob("*.py") if path.name != "__init__.py")
PROGRAM = Path(sysconfig.get_path("scripts")) / "flowtree"


def run(*arguments, **environment):
    return subprocess.run(
        [*arguments], env={**os.environ, **environment}, capture_output=True, text=True, check=False
    )


def compiled(folder):
    return sorted(path for path in folder.rglob("*.o"))


def test_every_kernel_file_is_found():
    assert [module.__name__ for module in kernel_modules()] == [f"flowtree.kernels.{name}" for name in FILES]


def test_compiles_all_once_and_says_where(tmp_path):
    first = run(PROGRAM, "warmup", WARP_CACHE_PATH=str(tmp_path))
    made = compiled(tmp_path)
    again = run(PROGRAM, "warmup", WARP_CACHE_PATH=str(tmp_path))
    assert (first.returncode, again.returncode) == (0, 0), first.stderr
    found = re.match(r"(.+): (\d+) kernel modules compiled, (\d+) were there\n", first.stdout)
    assert Path(found[1]).is_relative_to(tmp_path)
    assert (int(found[2]), int(found[3])) == (len(FILES), 0)
    assert len(made) == len(FILES)
    assert f": 0 kernel modules compiled, {len(FILES)} were there\n" in again.stdout
    assert "the loops of matting were there" in again.stdout, "Numba keeps what the first run compiled"
    assert compiled(tmp_path) == made
    for name in FILES:
        assert re.search(rf"^ *\d+% {name}$", first.stderr, re.MULTILINE)


@pytest.mark.parametrize("command", [["warmup"], ["demo", "-o", "trees"]], ids=lambda command: command[0])
def test_a_folder_that_cannot_be_written_is_told_in_one_line(tmp_path, command):
    (tmp_path / "file").write_bytes(b"")
    command = [str(tmp_path / word) if word == "trees" else word for word in command]
    ended = run(PROGRAM, *command, WARP_CACHE_PATH=str(tmp_path / "file"))
    assert ended.returncode == 1
    *_, line = ended.stderr.splitlines()
    assert line.startswith("flowtree: ")
    assert "compiled kernels cannot be kept there" in line
    assert "WARP_CACHE_PATH" in line
    assert "Traceback" not in ended.stderr


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="interrupts are sent otherwise here")
def test_an_interrupt_leaves_a_cache_that_can_be_used(tmp_path):
    environment = {**os.environ, "WARP_CACHE_PATH": str(tmp_path)}
    with subprocess.Popen([PROGRAM, "warmup"], env=environment, stderr=subprocess.PIPE, text=True) as running:
        assert running.stderr is not None
        assert running.stderr.readline() == "  0% start\n"
        while not any(tmp_path.rglob("*.cpp")):  # until it compiles
            assert running.poll() is None
            time.sleep(0.01)
        running.send_signal(signal.SIGINT)
        said = running.stderr.read()
    assert running.returncode == 130, said
    assert said.endswith("flowtree: stopped; every file is whole\n")
    assert len(compiled(tmp_path)) < len(FILES)
    assert run(PROGRAM, "warmup", WARP_CACHE_PATH=str(tmp_path)).returncode == 0
    assert len({path.parent for path in compiled(tmp_path)}) == len(FILES)


def test_importing_everything_compiles_nothing(tmp_path):
    program = (
        "import importlib, pkgutil, flowtree\n"
        "for module in pkgutil.walk_packages(flowtree.__path__, 'flowtree.'):\n"
        "    importlib.import_module(module.name)\n"
        "import sys; print(len([name for name in sys.modules if name.startswith('flowtree.')]))\n"
    )
    done = run(sys.executable, "-c", program, WARP_CACHE_PATH=str(tmp_path))
    assert done.returncode == 0, done.stderr
    assert int(done.stdout) > 150
    assert [path for path in tmp_path.rglob("*") if path.is_file()] == []
