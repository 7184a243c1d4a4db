"""Reads what a person points at in a photo: foot, top, first fork, seeds."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np

from flowtree import check
from flowtree.model.marks import ViewMarks
from flowtree.model.photo import Photo
from flowtree.photos.check_marks import check_marks
from flowtree.photos.read_drawn_json import is_number, is_pair, read_drawn_json

_FORM = '{"strokes": […], "foot": [x, y], "top": y, "fork": [x, y], "seeds": [[x, y], …]}'
_NUMBERS = ("roll", "distance", "focal_length")
_MARKS = tuple(field.name for field in fields(ViewMarks))


def read_marks(path: str | Path, photo: Photo) -> ViewMarks:
    """Reads the marks of one view from the JSON file that may hold its strokes, too.

    The file is ``{"strokes": […], "foot": [x, y], "top": y, "fork": [x, y], "seeds": [[x, y], …]}`` in pixels
    of the upright original photo, (0, 0) its upper left corner. Every name may be left out, or be null. Foot
    and top say where the tree stands and ends (Particle Flows gives both by hand, too); the trunk's first
    fork is the target of all livewire paths and the seeds are the tips they start from (section 4). A foot or
    a top that the frame cuts off may lie outside of it. ``"roll"`` [degrees], ``"distance"`` [m] and
    ``"focal_length"`` [mm, as on 36 x 24 mm film] say how the camera was held (`ViewMarks`). The strokes are
    left to the stage of the attractor graphs; a file of strokes alone, also as a bare list, has
    no marks.

    Args:
        path: the file.
        photo: the photo it belongs to.

    Returns: marks in working pixels, inside the picture.

    Raises:
        InputError: no such file, malformed, an unknown name, neither strokes nor marks, a place outside the
            picture, a foot not below the fork, or either of them not below the top.
    """
    file = Path(path)
    ending = file.suffix.lower()
    check.require(ending == ".json", file.name, "must end in .json", repr(ending), f"write {_FORM}")
    content = read_drawn_json(file, holds="marks", form=_FORM)
    if isinstance(content, list):
        content = {"strokes": content}
    kind = type(content).__name__
    check.require(isinstance(content, dict), file.name, "must hold strokes or marks", kind, f"write {_FORM}")
    known = ("strokes", *_MARKS)
    for key in content:
        if key not in known:
            remedy = check.nearest_name(key, known)
            check.fail(file.name, "must hold only known names", repr(key)[:40], remedy)
    some = any(content.get(key) not in (None, []) for key in known)
    check.require(some, file.name, "needs strokes or marks", "neither", f"write {_FORM}")
    marks = ViewMarks(
        foot=_point(content.get("foot"), f"{file.name}, foot"),
        top=_row(content.get("top"), f"{file.name}, top"),
        fork=_point(content.get("fork"), f"{file.name}, fork"),
        seeds=_points(content.get("seeds"), f"{file.name}, seeds"),
        **{name: _number(content.get(name), f"{file.name}, {name}") for name in _NUMBERS},
    )
    return check_marks(marks, photo, name=file.name, scale=photo.scale)


def _point(value: Any, name: str) -> tuple[float, float] | None:
    if value is None:
        return None
    check.require(is_pair(value), name, "must be a point [x, y]", repr(value)[:40], "give two numbers")
    return float(value[0]), float(value[1])


def _row(value: Any, name: str) -> float | None:
    if value is None:
        return None
    check.require(is_number(value), name, "must be a row y", repr(value)[:40], "give one number")
    return float(value)


def _number(value: Any, name: str) -> float | None:
    if value is None:
        return None
    check.require(is_number(value), name, "must be a number", repr(value)[:40], "give one number")
    return float(value)


def _points(value: Any, name: str) -> Any:
    """(k, 2) float64: the scale comes first, then float32."""
    if value is None:
        return np.zeros((0, 2))
    check.require(isinstance(value, list), name, "must be points [[x, y], …]", repr(value)[:40], "list them")
    wrong = [point for point in value if not is_pair(point)]
    check.require(
        not wrong, name, "must be points [[x, y], …]", repr(wrong[:1])[1:-1][:40], "give two numbers each"
    )
    return np.array(value, np.float64).reshape(-1, 2)
