"""Runs a command as a user would, and says what of its time was what."""

from __future__ import annotations

import os
import subprocess
import sysconfig
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from flowtree import check


class Watched(NamedTuple):
    """What became of a command that makes a tree [s].

    whole: from before it was started to after it had ended.
    begin: until its first stage began: Python's start, and all that it imports.
    end: from its last word to its end.
    """

    whole: float
    begin: float
    end: float


def find_program() -> Path:
    """``flowtree`` as installed beside this Python.

    Raises:
        InputError: it is not installed.
    """
    program = Path(sysconfig.get_path("scripts")) / "flowtree"
    check.require(program.is_file(), str(program), "must be installed", "no file", "pip install -e .")
    return program


def watch_command(arguments: Sequence[str], environment: Mapping[str, str] | None = None) -> Watched:
    """Runs ``flowtree`` with the arguments and notes when it says what: it says so without delay.

    Raises:
        InputError: it is not installed, failed, or made no tree.
    """
    command = [str(find_program()), *arguments]
    start = time.perf_counter()
    with subprocess.Popen(
        command, env={**os.environ, **(environment or {})}, stdout=subprocess.PIPE, stderr=subprocess.STDOUT
    ) as running:
        assert running.stdout is not None
        said = [(time.perf_counter() - start, line.decode(errors="replace")) for line in running.stdout]
        running.wait()
    whole = time.perf_counter() - start
    text = "".join(line for _, line in said).strip()[-300:]
    check.require(running.returncode == 0, f"flowtree {arguments[0]}", "must succeed", text, "mend it")
    begun = next((when for when, line in said if "% photos" in line), None)
    if begun is None:
        check.fail(f"flowtree {arguments[0]}", "must make a tree", text, "watch a command that does")
    return Watched(whole, begun, whole - said[-1][0])
