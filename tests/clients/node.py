"""JavaScript programs that read our files: Khronos' glTF validator and three.js, run by Node."""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import subprocess
import tempfile
from functools import lru_cache
from pathlib import Path
from typing import Any, NoReturn

import pytest

_HERE = Path(__file__).parent
_INSTALL_SECONDS, _RUN_SECONDS = 180, 120


def validate_glb(*paths: Path) -> list[dict[str, Any]]:
    """Has the files checked by gltf-validator and fails the test where it finds an error.

    Returns: a file's ``{"issues": {"numErrors", "numWarnings", "messages", …}, "info": {…}}`` each.
    """
    reports = _run("validate_glb.mjs", paths)
    for path, report in zip(paths, reports, strict=True):
        errors = [message for message in report["issues"]["messages"] if message["severity"] == 0]
        assert not errors, f"{path.name}: {errors[:5]}"
    return reports


def load_in_three(*paths: Path) -> list[dict[str, Any]]:
    """Loads the files with three.js.

    Returns: a file's ``{"nodes": [name, …], "meshes": {name: {"triangles", …}}, "bounds": [min, max]}`` each.
    """
    return _run("load_in_three.mjs", paths)


def _run(script: str, paths: tuple[Path, ...]) -> list[dict[str, Any]]:
    command = ["node", str(_HERE / script), *(str(path.resolve()) for path in paths)]
    done = subprocess.run(
        command, cwd=modules(), capture_output=True, text=True, timeout=_RUN_SECONDS, check=False
    )
    assert done.returncode == 0, done.stderr[-2000:]
    reports: list[dict[str, Any]] = json.loads(done.stdout)
    return reports


def modules() -> Path:
    """The folder with node_modules; skips the test where it cannot be had, except in CI, where it must be."""
    folder, reason = _install()
    if folder is None:
        give_up(reason)
    return folder


def give_up(reason: str) -> NoReturn:
    if os.environ.get("CI", "").lower() in {"1", "true"}:
        pytest.fail(f"CI needs every program that reads our files: {reason}")
    pytest.skip(reason)


@lru_cache(maxsize=1)
def _install() -> tuple[Path | None, str]:
    """Installs what package.json pins, once per content of that file, and keeps it for later runs."""
    if shutil.which("node") is None or shutil.which("npm") is None:
        return None, "node or npm is not installed"
    wanted = (_HERE / "package.json").read_bytes()
    cache = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "flowtree-tests"
    folder = cache / hashlib.sha256(wanted).hexdigest()[:16]
    if folder.is_dir():
        return folder, ""
    try:
        cache.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        return None, f"no place to install them: {error}"
    with tempfile.TemporaryDirectory(dir=cache) as fresh:
        (Path(fresh) / "package.json").write_bytes(wanted)
        command = ["npm", "install", "--ignore-scripts", "--no-audit", "--no-fund", "--no-package-lock"]
        try:
            done = subprocess.run(
                command, cwd=fresh, capture_output=True, text=True, timeout=_INSTALL_SECONDS, check=False
            )
        except subprocess.TimeoutExpired:
            return None, f"npm install took over {_INSTALL_SECONDS} s"
        if done.returncode:
            return None, f"npm install failed: {done.stderr.strip()[:300]}"
        # Only a finished installation gets the name; a run beside this one may have been quicker.
        finished = Path(fresh) / "done"
        finished.mkdir()
        for name in ("package.json", "node_modules"):
            (Path(fresh) / name).rename(finished / name)
        if not folder.is_dir():
            finished.rename(folder)
    return folder, ""
