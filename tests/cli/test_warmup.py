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


@pytest.fixture(scope="module")
def interrupted(tmp_path_factory):
    """A cache whose first compiling was interrupted, and what was said then."""
    folder = tmp_path_factory.mktemp("cache")
    environment = {**os.environ, "WARP_CACHE_PATH": str(folder)}
    with subprocess.Popen([PROGRAM, "warmup"], env=environment, stderr=subprocess.PIPE, text=True) as running:
        assert running.stderr is not None
        assert running.stderr.readline() == "  0% start\n"
        while not any(folder.rglob("*.cpp")):  # until it compiles
            assert running.poll() is None
            time.sleep(0.01)
        running.send_signal(signal.SIGINT)
        said = running.stderr.read()
    assert running.returncode == 130, said
    assert said.endswith("flowtree: stopped; every file is whole\n")
    return folder


def test_what_an_interrupt_left_is_compiled_once_and_it_is_said_where(interrupted):
    there = len(compiled(interrupted))
    assert there < len(FILES)
    first = run(PROGRAM, "warmup", WARP_CACHE_PATH=str(interrupted))
    made = compiled(interrupted)
    again = run(PROGRAM, "warmup", WARP_CACHE_PATH=str(interrupted))
    assert (first.returncode, again.returncode) == (0, 0), first.stderr
    found = re.match(r"(.+): (\d+) kernel modules compiled, (\d+) were there\n", first.stdout)
    assert Path(found[1]).is_relative_to(interrupted)
    assert (int(found[2]), int(found[3])) == (len(FILES) - there, there)
    assert len({path.parent for path in made}) == len(made) == len(FILES)
    assert f": 0 kernel modules compiled, {len(FILES)} were there\n" in again.stdout
    assert "the loops of matting were there" in again.stdout, "Numba keeps what the first run compiled"
    assert compiled(interrupted) == made
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
