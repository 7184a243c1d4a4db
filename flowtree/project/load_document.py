"""Reads a project's folder as a document, with its history."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

from flowtree import check
from flowtree.configuration import params_from_table
from flowtree.errors import FlowtreeError
from flowtree.params import Params
from flowtree.photos.picture_size import picture_size
from flowtree.pipeline.choose_yaws import choose_yaws
from flowtree.project.command_json import command_from_json
from flowtree.project.document import Document, Step
from flowtree.project.document_state import DocumentState, DrawnPhoto
from flowtree.project.drawn_files import read_drawn_file
from flowtree.project.load_project import load_project
from flowtree.project.project import PER_PHOTO, Project
from flowtree.project.save_document import HISTORY_FORMAT
from flowtree.project.save_project import PICTURE_PARAMS
from flowtree.project.state_json import state_from_json


def load_document(folder: Path) -> tuple[Document, str | None]:
    """The document of a folder that `save_document` or `save_project` wrote.

    Where the project was changed since by somebody else, or its history is damaged, the project counts and
    there is nothing to undo.

    Returns: the document, and a line that says why there is no history, where there should be one.

    Raises:
        InputError: no project there, or a damaged one.
    """
    state = _state(load_project(folder), folder)
    file = folder / "history.json"
    if not file.is_file():
        return Document(state), None
    try:
        document = _history(json.loads(file.read_text(encoding="utf-8")))
    except (
        FlowtreeError,
        ValueError,
        RecursionError,
        OSError,
        TypeError,
        LookupError,
        AttributeError,
    ) as error:
        return Document(state), check.one_line(
            f"history.json could not be read, nothing can be undone: {error}"
        )
    if document.state != state:
        return Document(state), "the project was changed elsewhere: nothing before that can be undone"
    missing = sorted(
        {place for each in document.states() for place in each.places() if not _is_held(place, folder)}
    )
    if missing:
        return Document(state), check.one_line(f"{missing[0]} is not in the project: nothing can be undone")
    return document, None


def _is_held(place: str, folder: Path) -> bool:
    """Whether a file of the folder has that place: a strange project must not read what lies around it."""
    if "\0" in place:
        return False
    file = folder / place
    return file.resolve().is_relative_to(folder.resolve()) and file.is_file()


def _history(table: Any) -> Document:
    known = isinstance(table, dict) and table.get("flowtree_history") == HISTORY_FORMAT
    check.require(known, "history", f"must be of format {HISTORY_FORMAT}", "another", "remove history.json")
    steps = []
    for step in table["steps"]:
        gesture = step.pop("gesture", None)
        steps.append(Step(command_from_json(step, files=True), gesture))
    return Document(state_from_json(table["base"]), steps, int(table["position"]))


def _state(project: Project, folder: Path) -> DocumentState:
    base = folder.resolve()
    params = project.params.model_dump()
    pictures = []
    for section, key in PICTURE_PARAMS:
        picture = params[section][key]
        if picture not in (None, "", "auto"):
            pictures.append((f"{section}.{key}", _place(Path(picture), base)))
            params[section][key] = Params.model_fields[section].default.model_dump()[key]
    count = len(project.photos)
    known = project.yaws is not None and len(project.yaws) == count
    yaws = project.yaws if known and project.yaws is not None else choose_yaws(max(count, 1))
    return DocumentState(
        photos=tuple(_photo(project, k, yaws[k], base) for k in range(count)),
        height=project.height,
        seed=project.seed,
        params=params_from_table(params),
        pictures=tuple(sorted(pictures)),
    )


def _photo(project: Project, number: int, yaw: float, base: Path) -> DrawnPhoto:
    file = project.photos[number]
    width, height = picture_size(file)
    photo = DrawnPhoto(_place(file, base), width, height, yaw)
    for kind in PER_PHOTO:
        beside = getattr(project, kind).get(number)
        if beside is None:
            continue
        said = None if kind in ("mattes", "trimaps") else read_drawn_file(kind, beside, file)
        if said is None:
            photo = replace(photo, attached=(*photo.attached, (kind, _place(beside, base))))
        else:
            photo = replace(photo, **said)
    return photo


def _place(file: Path, base: Path) -> str:
    return file.resolve().relative_to(base).as_posix()
