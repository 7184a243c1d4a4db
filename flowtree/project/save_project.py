"""Saves a project as a folder."""

from __future__ import annotations

import contextlib
import hashlib
import json
from pathlib import Path
from typing import Any

from flowtree import check
from flowtree.configuration import params_to_toml
from flowtree.errors import OutputError
from flowtree.files import write_all_whole
from flowtree.params import Params
from flowtree.project.project import PER_PHOTO, Project

FORMAT = 1
# Parameters that may name a picture: it moves into the project with the rest.
PICTURE_PARAMS = (("meshing", "bark"), ("leaves", "picture"))


def save_project(project: Project, folder: str | Path) -> None:
    """Writes ``project.json``, ``params.toml`` and a copy of every file the project uses.

    A copy lies in a folder named by its content (``photos/1a2b3c4d5e6f/oak.jpg``), so an older copy is never
    overwritten and saving again copies nothing twice. The two small files take their places last: before that
    the folder holds the project that it held. What else lies in the folder is left alone; copies that the
    project no longer uses are removed at the end.

    Args:
        project: what to save.
        folder: made if there is none.

    Raises:
        InputError: a file of the project cannot be read.
        OutputError: the folder cannot be written; what it held is untouched.
    """
    base = Path(folder)
    contents: dict[Path, bytes] = {}
    table: dict[str, Any] = {
        "flowtree_project": FORMAT,
        "photos": [_copy("photos", photo, contents) for photo in project.photos],
        "yaws": None if project.yaws is None else list(project.yaws),
        "height": project.height,
        "seed": project.seed,
    }
    for kind in PER_PHOTO:
        files = getattr(project, kind)
        table[kind] = {str(k): _copy(kind, files[k], contents) for k in sorted(files)}
    params = project.params.model_dump()
    table["pictures"] = {}
    for section, name in PICTURE_PARAMS:
        picture = params[section][name]
        if picture not in (None, "", "auto"):
            table["pictures"][f"{section}.{name}"] = _copy("pictures", Path(picture), contents)
            params[section][name] = type(project.params).model_fields[section].default.model_dump()[name]
    copies = set(contents)
    missing = {path: data for path, data in contents.items() if not (base / path).is_file()}
    missing[Path("params.toml")] = params_to_toml(Params.model_validate(params)).encode()
    missing[Path("project.json")] = (json.dumps(table, indent=2, ensure_ascii=False) + "\n").encode()
    made = _make_folders(base, missing)
    try:
        write_all_whole({base / path: data for path, data in missing.items()})
    except BaseException:
        for new in reversed(made):
            with contextlib.suppress(OSError):
                new.rmdir()
        raise
    _remove_unused(base, copies)


def _copy(kind: str, file: Path, contents: dict[Path, bytes]) -> str:
    """Notes a file's content under its place in the project, and returns that place."""
    try:
        data = file.read_bytes()
    except OSError as error:
        check.fail(str(file), "must be a file that can be read", error.strerror, "check the path")
    place = Path(kind) / hashlib.sha256(data).hexdigest()[:12] / file.name
    contents[place] = data
    return place.as_posix()


def _make_folders(base: Path, contents: dict[Path, bytes]) -> list[Path]:
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


def _remove_unused(base: Path, copies: set[Path]) -> None:
    """Removes copies of an earlier save; a file that cannot be removed harms nobody."""
    for kind in ("photos", "pictures", *PER_PHOTO):
        for file in (base / kind).glob("*/*"):
            named_by_content = len(file.parent.name) == 12 and set(file.parent.name) <= set(
                "0123456789abcdef"
            )
            if named_by_content and file.relative_to(base) not in copies:
                with contextlib.suppress(OSError):
                    file.unlink()
                    file.parent.rmdir()
