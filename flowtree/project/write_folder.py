"""Writes a project's folder whole, or leaves it as it is."""

from __future__ import annotations

import contextlib
import hashlib
import json
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any

from flowtree import check
from flowtree.configuration import params_to_toml
from flowtree.errors import OutputError
from flowtree.files import write_all_whole
from flowtree.params import Params
from flowtree.project.project import PER_PHOTO

FORMAT = 1


def place_of(kind: str, name: str, data: bytes) -> str:
    """Where in the folder a copy lies: in a folder named by its content."""
    return f"{kind}/{hashlib.sha256(data).hexdigest()[:12]}/{name}"


def write_folder(
    base: Path,
    table: Mapping[str, Any],
    params: Params,
    copies: Mapping[str, bytes],
    *,
    history: bytes | None = None,
    keep: Collection[str] = (),
) -> None:
    """Writes ``project.json``, ``params.toml``, ``history.json`` and the copies that are not yet there.

    The small files take their places last: before that the folder holds the project that it held. What else
    lies in the folder is left alone; copies that nothing names are removed at the end.

    Args:
        base: the folder; made if there is none.
        table: of ``project.json``, without the format.
        params: of ``params.toml``.
        copies: content by place.
        history: content of ``history.json``; None removes one that told of another project.
        keep: places that stay besides the copies.

    Raises:
        OutputError: the folder cannot be written; what it held is untouched.
    """
    listed = {"flowtree_project": FORMAT, **table}
    wanted = {Path(place): data for place, data in copies.items() if not (base / place).is_file()}
    wanted[Path("params.toml")] = params_to_toml(params).encode()
    if history is not None:
        wanted[Path("history.json")] = history
    wanted[Path("project.json")] = (json.dumps(listed, indent=2, ensure_ascii=False) + "\n").encode()
    made = _make_folders(base, wanted)
    try:
        write_all_whole({base / path: data for path, data in wanted.items()})
    except BaseException:
        for new in reversed(made):
            with contextlib.suppress(OSError):
                new.rmdir()
        raise
    if history is None:
        with contextlib.suppress(OSError):
            (base / "history.json").unlink(missing_ok=True)
    _remove_unused(base, {*copies, *keep})


def _make_folders(base: Path, contents: Mapping[Path, bytes]) -> list[Path]:
    """Makes the folders that the files need; returns the new ones, outer before inner."""
    made: list[Path] = []
    for path in contents:
        folder = (base / path).parent
        wanted = [p for p in (*reversed(folder.parents), folder) if not p.exists()]
        for new in wanted:
            try:
                new.mkdir()
            except OSError as error:
                for old in reversed(made):
                    with contextlib.suppress(OSError):
                        old.rmdir()
                reason = f"{base}: could not be written: {error.strerror}; name another folder"
                raise OutputError(check.one_line(reason)) from error
            made.append(new)
    return made


def _remove_unused(base: Path, used: Collection[str]) -> None:
    """Removes copies of an earlier save; a file that cannot be removed harms nobody."""
    for kind in ("photos", "pictures", *PER_PHOTO):
        for file in (base / kind).glob("*/*"):
            named_by_content = len(file.parent.name) == 12 and set(file.parent.name) <= set(
                "0123456789abcdef"
            )
            if named_by_content and file.relative_to(base).as_posix() not in used:
                with contextlib.suppress(OSError):
                    file.unlink()
                    file.parent.rmdir()
