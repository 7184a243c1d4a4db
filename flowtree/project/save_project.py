"""Saves a project as a folder."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from flowtree import check
from flowtree.params import Params
from flowtree.project.project import PER_PHOTO, Project
from flowtree.project.write_folder import place_of, write_folder

# Parameters that may name a picture: it moves into the project with the rest.
PICTURE_PARAMS = (("meshing", "bark"), ("leaves", "picture"), ("twigs", "sketch"))


def save_project(project: Project, folder: str | Path) -> None:
    """Writes ``project.json``, ``params.toml`` and a copy of every file the project uses.

    A copy lies in a folder named by its content (``photos/1a2b3c4d5e6f/oak.jpg``), so an older copy is never
    overwritten and saving again copies nothing twice. The two small files take their places last: before that
    the folder holds the project that it held. What else lies in the folder is left alone; copies that the
    project no longer uses are removed at the end, and so is a history that told of another project.

    Args:
        project: what to save.
        folder: made if there is none.

    Raises:
        InputError: a file of the project cannot be read.
        OutputError: the folder cannot be written; what it held is untouched.
    """
    copies: dict[str, bytes] = {}
    table: dict[str, Any] = {
        "photos": [_copy("photos", photo, copies) for photo in project.photos],
        "yaws": None if project.yaws is None else list(project.yaws),
        "height": project.height,
        "seed": project.seed,
    }
    for kind in PER_PHOTO:
        files = getattr(project, kind)
        table[kind] = {str(k): _copy(kind, files[k], copies) for k in sorted(files)}
    params = project.params.model_dump()
    table["pictures"] = {}
    for section, name in PICTURE_PARAMS:
        picture = params[section][name]
        if picture not in (None, "", "auto"):
            table["pictures"][f"{section}.{name}"] = _copy("pictures", Path(picture), copies)
            params[section][name] = type(project.params).model_fields[section].default.model_dump()[name]
    write_folder(Path(folder), table, Params.model_validate(params), copies)


def _copy(kind: str, file: Path, copies: dict[str, bytes]) -> str:
    """Notes a file's content under its place in the project, and returns that place."""
    try:
        data = file.read_bytes()
    except OSError as error:
        check.fail(str(file), "must be a file that can be read", error.strerror, "check the path")
    place = place_of(kind, file.name, data)
    copies[place] = data
    return place
