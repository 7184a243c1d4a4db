"""Reads a project's folder."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from flowtree import check
from flowtree.configuration import load_params, params_from_table
from flowtree.project.project import PER_PHOTO, Project
from flowtree.project.save_project import PICTURE_PARAMS
from flowtree.project.write_folder import FORMAT

_SAVE_AGAIN = "save it again with `flowtree reconstruct PHOTO … --project DIR`"


def load_project(folder: str | Path) -> Project:
    """The project of a folder that `save_project` wrote; ``params.toml`` may have been edited since.

    Raises:
        InputError: no project there, a damaged or newer one, a file of it missing or outside the folder, or
            parameters that break their rules.
    """
    base = Path(folder)
    name = str(base / "project.json")
    try:
        table = json.loads((base / "project.json").read_text(encoding="utf-8"))
    except OSError as error:
        remedy = "name a project's folder, or make one with `flowtree reconstruct PHOTO … --project DIR`"
        check.fail(name, "must be a file that can be read", error.strerror, remedy)
    except (ValueError, RecursionError) as error:
        check.fail(name, "must be JSON", f"something else ({error})", _SAVE_AGAIN)
    known = isinstance(table, dict) and table.get("flowtree_project") == FORMAT
    got = table.get("flowtree_project") if isinstance(table, dict) else type(table).__name__
    check.require(known, name, f"must be a flowtree project of format {FORMAT}", repr(got), _SAVE_AGAIN)
    photos = table.get("photos")
    listed = isinstance(photos, list)
    check.require(listed, name, "needs a list of photos", repr(photos)[:60], _SAVE_AGAIN)
    copies = tuple(_file(base, place, name) for place in photos)
    params = load_params(base / "params.toml")
    pictures = _mapping(table.get("pictures", {}), name)
    values = params.model_dump()
    for section, key in PICTURE_PARAMS:
        if f"{section}.{key}" in pictures:
            values[section][key] = str(_file(base, pictures[f"{section}.{key}"], name))
    files = {
        kind: {
            _photo(k, len(photos), name): _file(base, place, name)
            for k, place in _mapping(table.get(kind, {}), name).items()
        }
        for kind in PER_PHOTO
    }
    return Project(
        photos=copies,
        yaws=_yaws(table.get("yaws"), name),
        height=_number(table.get("height"), "height", name),
        seed=_seed(table.get("seed", 0), name),
        params=params_from_table(values, source=f"{base / 'params.toml'}: "),
        **files,
    )


def _mapping(value: Any, name: str) -> dict[str, Any]:
    check.require(isinstance(value, dict), name, "must list files by name", repr(value)[:60], _SAVE_AGAIN)
    return dict(value)


def _file(base: Path, place: Any, name: str) -> Path:
    """A file inside the folder: a project from elsewhere must not read what lies around it."""
    named = isinstance(place, str) and "\0" not in place
    check.require(named, name, "must name files", repr(place)[:60], _SAVE_AGAIN)
    path = base / str(place)
    inside = path.resolve().is_relative_to(base.resolve())
    check.require(inside, name, "must name files inside the project", place, _SAVE_AGAIN)
    check.require(path.is_file(), str(path), "must be there", "nothing", _SAVE_AGAIN)
    return path


def _photo(text: str, count: int, name: str) -> int:
    valid = text.isdecimal() and int(text) < count
    check.require(valid, name, f"must count photos from 0 to {count - 1}", repr(text)[:40], _SAVE_AGAIN)
    return int(text)


def _number(value: Any, what: str, name: str) -> float | None:
    valid = value is None or (isinstance(value, int | float) and not isinstance(value, bool))
    check.require(valid, name, f"needs a number as {what}", repr(value)[:40], _SAVE_AGAIN)
    return None if value is None else float(value)


def _yaws(value: Any, name: str) -> tuple[float, ...] | None:
    if value is None:
        return None
    check.require(isinstance(value, list), name, "needs a list of yaws", repr(value)[:40], _SAVE_AGAIN)
    return tuple(_number(yaw, "yaw", name) or 0.0 for yaw in value)


def _seed(value: Any, name: str) -> int:
    valid = isinstance(value, int) and not isinstance(value, bool)
    check.require(valid, name, "needs a whole number as seed", repr(value)[:40], _SAVE_AGAIN)
    return int(value)
