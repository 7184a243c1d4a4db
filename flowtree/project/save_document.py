"""Saves a document as a project's folder, with its history."""

from __future__ import annotations

import json
from pathlib import Path, PurePosixPath
from typing import Any

from flowtree.configuration import params_from_table
from flowtree.project.command_json import command_to_json
from flowtree.project.document import Document
from flowtree.project.document_state import DocumentState
from flowtree.project.drawn_files import drawn_files
from flowtree.project.project import PER_PHOTO, Project
from flowtree.project.state_json import state_to_json
from flowtree.project.write_folder import place_of, write_folder

HISTORY_FORMAT = 1


def save_document(document: Document, folder: Path) -> None:
    """Writes the state as a project that every command reads, and beside it what can be undone.

    Photos and pictures lie in the folder already, those of states that can be undone to stay there.

    Raises:
        OutputError: the folder cannot be written; what it held is untouched.
    """
    state = document.state
    table, drawn = _table(state)
    keep = set().union(*(each.places() for each in document.states()))
    history = {
        "flowtree_history": HISTORY_FORMAT,
        "base": state_to_json(document.base),
        "steps": [command_to_json(step.command) | _gesture(step.gesture) for step in document.steps],
        "position": document.position,
    }
    data = (json.dumps(history, ensure_ascii=False) + "\n").encode()
    write_folder(folder, table, state.params, drawn, history=data, keep=keep)


def lay_out_project(state: DocumentState, folder: Path, scratch: Path) -> Project:
    """The project of a state, without saving it: drawings lie in another folder.

    The files have the names and contents that they have in the saved project, and so has the tree.

    Args:
        state: what to lay out.
        folder: of the project, which holds its photos and pictures.
        scratch: where drawings are written; those that lie there already are not written again.

    Raises:
        OSError: the scratch folder cannot be written.
    """
    table, drawn = _table(state)
    for place, data in drawn.items():
        file = scratch / place
        if not file.is_file():
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_bytes(data)
    values = state.params.model_dump()
    for name, place in state.pictures:
        section, key = name.split(".")
        values[section][key] = str(folder / place)
    files = {
        kind: {int(k): (scratch if place in drawn else folder) / place for k, place in table[kind].items()}
        for kind in PER_PHOTO
    }
    return Project(
        photos=tuple(folder / photo.place for photo in state.photos),
        yaws=tuple(photo.yaw for photo in state.photos),
        height=state.height,
        seed=state.seed,
        params=params_from_table(values),
        **files,
    )


def _table(state: DocumentState) -> tuple[dict[str, Any], dict[str, bytes]]:
    """What ``project.json`` lists, and the files of drawings by their places."""
    drawn: dict[str, bytes] = {}
    table: dict[str, Any] = {
        "photos": [photo.place for photo in state.photos],
        "yaws": [photo.yaw for photo in state.photos],
        "height": state.height,
        "seed": state.seed,
        **{kind: {} for kind in PER_PHOTO},
        "pictures": dict(state.pictures),
    }
    for number, photo in enumerate(state.photos):
        for kind, place in photo.attached:
            table[kind][str(number)] = place
        for kind, data in drawn_files(photo).items():
            stem = PurePosixPath(photo.place).stem
            place = place_of(kind, f"{stem}.{kind}.json", data)
            table[kind][str(number)] = place
            drawn[place] = data
    return table, drawn


def _gesture(gesture: str | None) -> dict[str, str]:
    return {} if gesture is None else {"gesture": gesture}
