"""A document's state as JSON and back."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from flowtree import check
from flowtree.configuration import params_from_table
from flowtree.photos.read_picks import check_colors
from flowtree.project.document_state import DocumentState, DrawnPhoto
from flowtree.project.drawings import BranchStroke, Marks, PaintStroke, Scribble
from flowtree.project.read_fields import read_fields

_MARKS = ("foot", "top", "fork", "seeds", "roll", "distance", "focal_length")
_PHOTO = ("place", "width", "height", "yaw")


def state_to_json(state: DocumentState) -> dict[str, Any]:
    """The whole state; JSON has lists where it has tuples."""
    return {
        "photos": [asdict(photo) for photo in state.photos],
        "height": state.height,
        "seed": state.seed,
        "params": state.params.model_dump(mode="json"),
        "pictures": dict(state.pictures),
    }


def state_from_json(table: Any) -> DocumentState:
    """The state that `state_to_json` gave.

    Raises:
        InputError: it gave something else.
    """
    thing = "state"
    held = isinstance(table, dict) and isinstance(table.get("photos"), list) and "params" in table
    check.require(held, thing, "must hold photos and params", repr(table)[:60], "remove history.json")
    rest = {name: table[name] for name in ("height", "seed") if name in table}
    values = read_fields(rest, thing, required=("height", "seed"), optional=())
    return DocumentState(
        photos=tuple(_photo(photo) for photo in table["photos"]),
        params=params_from_table(table["params"]),
        pictures=_pairs(table.get("pictures", {})),
        **values,
    )


def scribble_from_json(table: Any, thing: str) -> Scribble:
    """One scribble.

    Raises:
        InputError: it is none.
    """
    return Scribble(**read_fields(table, thing, required=("label", "width", "points"), optional=()))


def stroke_from_json(table: Any, thing: str) -> BranchStroke:
    """One drawn branch.

    Raises:
        InputError: it is none.
    """
    return BranchStroke(**read_fields(table, thing, required=("points",), optional=("width", "snapped")))


def paint_from_json(table: Any, thing: str) -> PaintStroke:
    """One painted stroke.

    Raises:
        InputError: it is none.
    """
    names = ("kind", "width", "points"), ("softness", "strength")
    return PaintStroke(**read_fields(table, thing, required=names[0], optional=names[1]))


def marks_from_json(table: Any, thing: str) -> Marks:
    """A photo's marks.

    Raises:
        InputError: they are none.
    """
    return Marks(**read_fields(table, thing, required=(), optional=_MARKS))


def _photo(table: Any) -> DrawnPhoto:
    check.require(
        isinstance(table, dict), "photo", "must be an object", repr(table)[:40], "remove history.json"
    )
    plain = read_fields(
        {name: table[name] for name in _PHOTO if name in table}, "photo", required=_PHOTO, optional=()
    )
    plain |= {side: int(plain[side]) for side in ("width", "height")}
    return DrawnPhoto(
        marks=marks_from_json(table.get("marks", {}), "marks"),
        scribbles=tuple(scribble_from_json(one, "scribble") for one in _list(table, "scribbles")),
        tree_colors=check_colors(table.get("tree_colors", []), "tree_colors"),
        background_colors=check_colors(table.get("background_colors", []), "background_colors"),
        strokes=tuple(stroke_from_json(one, "stroke") for one in _list(table, "strokes")),
        paint=tuple(paint_from_json(one, "paint") for one in _list(table, "paint")),
        attached=tuple((str(kind), str(place)) for kind, place in _list(table, "attached")),
        **plain,
    )


def _list(table: dict[str, Any], name: str) -> list[Any]:
    value = table.get(name, [])
    check.require(isinstance(value, list), name, "must be a list", repr(value)[:40], "remove history.json")
    return list(value)


def _pairs(value: Any) -> tuple[tuple[str, str], ...]:
    check.require(
        isinstance(value, dict), "pictures", "must list files by name", repr(value)[:40], "look again"
    )
    return tuple(sorted((str(name), str(place)) for name, place in value.items()))
