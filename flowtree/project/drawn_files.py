"""The drawings of a photo as the files that every command reads, and back."""

from __future__ import annotations

import json
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

import numpy as np

from flowtree import check
from flowtree.photos.load_photo import load_photo
from flowtree.photos.read_drawn_json import read_drawn_json
from flowtree.photos.read_picks import check_colors
from flowtree.project.document_state import DrawnPhoto
from flowtree.project.drawings import BranchStroke, Marks
from flowtree.project.state_json import marks_from_json, paint_from_json, scribble_from_json, stroke_from_json

_COLORS = ("tree_colors", "background_colors")
_MARKS = tuple(field.name for field in fields(Marks))


def drawn_files(photo: DrawnPhoto) -> dict[str, bytes]:
    """The content of a photo's JSON files by their kind: strokes and marks, scribbles and colours, paint.

    What is not drawn has no file. The same drawings give the same bytes.
    """
    marks = {name: value for name, value in asdict(photo.marks).items() if value not in (None, ())}
    tables: dict[str, dict[str, Any]] = {}
    if photo.strokes or marks:
        tables["strokes"] = {"strokes": [asdict(stroke) for stroke in photo.strokes], **marks}
    colors = {name: getattr(photo, name) for name in _COLORS if getattr(photo, name)}
    if photo.scribbles or colors:
        tables["scribbles"] = {"strokes": [asdict(scribble) for scribble in photo.scribbles], **colors}
    if photo.paint:
        tables["paint"] = {"layers": [asdict(stroke) for stroke in photo.paint]}
    return {kind: (json.dumps(table) + "\n").encode() for kind, table in tables.items()}


def read_drawn_file(kind: str, file: Path, photo: Path) -> dict[str, Any] | None:
    """The fields of a `DrawnPhoto` that a file beside it says; None if it is a picture, or no drawing.

    Strokes from SVG and PNG become the polylines that the pipeline makes of them.

    Args:
        kind: "strokes", "scribbles" or "paint".
        file: which one.
        photo: the photo it belongs to.

    Raises:
        InputError: the file is none of that kind.
    """
    if kind == "strokes" and file.suffix.lower() != ".json":
        from flowtree.attraction.read_strokes import read_strokes  # heavy, and few have such a file

        shown = load_photo(photo)
        lines = (np.asarray(line, np.float64) / shown.scale for line in read_strokes(file, shown))
        return {"strokes": tuple(BranchStroke(tuple((x, y) for x, y in line.tolist())) for line in lines)}
    if file.suffix.lower() != ".json":
        return None
    name = file.name
    content = read_drawn_json(file, holds=kind, form="what flowtree reads")
    if kind == "scribbles":
        items = _items(content, "strokes", name)
        drawn = tuple(scribble_from_json({"width": 8, **one}, name) for one in items)
        return {
            "scribbles": drawn,
            **{key: check_colors(content.get(key, []), name) for key in _COLORS},
        }
    if kind == "paint":
        items = _items(content, "layers", name)
        return {"paint": tuple(paint_from_json({"width": 40, **one}, name) for one in items)}
    if isinstance(content, list):
        content = {"strokes": content}
    marks = {key: content[key] for key in _MARKS if content.get(key) is not None}
    content = {
        "strokes": [one if isinstance(one, dict) else {"points": one} for one in content.get("strokes") or []]
    }
    items = _items(content, "strokes", name)
    known = ("points", "width", "snapped")
    strokes = ({key: one[key] for key in known if key in one} for one in items)
    return {
        "strokes": tuple(stroke_from_json(one, name) for one in strokes),
        "marks": marks_from_json(marks, name),
    }


def _items(content: Any, key: str, name: str) -> list[dict[str, Any]]:
    items = content.get(key) if isinstance(content, dict) else None
    fits = isinstance(items, list) and all(isinstance(item, dict) for item in items)
    check.require(fits, name, f'must hold a list "{key}" of objects', type(content).__name__, "write it anew")
    return list(items or [])
