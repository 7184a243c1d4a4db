"""Blender, as the Python module that its makers publish, in a process and a folder of its own."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from functools import lru_cache
from pathlib import Path
from typing import Any

import pytest

_HERE = Path(__file__).parent
_PACKAGE = "bpy==5.0.1"  # 370 MB, made for Python 3.11 alone
_PYTHON = (3, 11)
_INSTALL_SECONDS, _RUN_SECONDS = 120, 180


def load_in_blender(*paths: Path) -> list[dict[str, Any]]:
    """Imports each GLB or USD into an empty Blender; skips the test where that cannot be had.

    Returns: a file's ``{"meshes": {object: triangles}, "bounds": [low, high] [m], z up, "bones", "actions",
        "materials", "attributes"}`` each.
    """
    folder, reason = _install()
    if folder is None:
        pytest.skip(reason)
    script = [sys.executable, str(_HERE / "load_in_blender.py"), *(str(path.resolve()) for path in paths)]
    done = subprocess.run(
        script,
        env={**os.environ, "PYTHONPATH": str(folder)},
        capture_output=True,
        text=True,
        timeout=_RUN_SECONDS,
        check=False,
    )
    assert done.returncode == 0, done.stderr[-2000:]
    # Blender's importers talk on the same stream.
    (line,) = [line for line in done.stdout.splitlines() if line.startswith("REPORTS ")]
    reports: list[dict[str, Any]] = json.loads(line.removeprefix("REPORTS "))
    return reports


@lru_cache(maxsize=1)
def _install() -> tuple[Path | None, str]:
    """Installs Blender once, beside other tests' programs, and keeps it for later runs."""
    if sys.version_info[:2] != _PYTHON:
        return None, f"{_PACKAGE} needs Python {'.'.join(map(str, _PYTHON))}"
    cache = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "flowtree-tests"
    folder = cache / _PACKAGE.replace("==", "-")
    if folder.is_dir():
        return folder, ""
    if not os.environ.get("FLOWTREE_INSTALL_CLIENTS"):
        return None, "Blender is not there; FLOWTREE_INSTALL_CLIENTS=1 fetches its 370 MB"
    try:
        cache.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        return None, f"no place to install Blender: {error}"
    with tempfile.TemporaryDirectory(dir=cache) as fresh:
        finished = Path(fresh) / "done"
        command = [sys.executable, "-m", "pip", "install", "-q", "--no-compile", "--target", str(finished)]
        try:
            done = subprocess.run(
                [*command, _PACKAGE],
                capture_output=True,
                text=True,
                timeout=_INSTALL_SECONDS,
                check=False,
            )
        except subprocess.TimeoutExpired:
            return None, f"installing {_PACKAGE} took over {_INSTALL_SECONDS} s"
        if done.returncode:
            return None, f"installing {_PACKAGE} failed: {done.stderr.strip()[-300:]}"
        # Only a finished installation gets the name; a run beside this one may have been quicker.
        if not folder.is_dir():
            finished.rename(folder)
    return folder, ""
