"""Values of JSON from elsewhere as those that drawings and commands hold."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from flowtree import check
from flowtree.photos.read_drawn_json import is_number, is_pair
from flowtree.project.drawings import Point, Points


def read_fields(
    table: Any, thing: str, *, required: tuple[str, ...], optional: tuple[str, ...]
) -> dict[str, Any]:
    """The named values of a JSON object, each of the kind that its name says.

    Args:
        table: what came.
        thing: what it should be, for the error.
        required: names that must be there.
        optional: names that may be.

    Raises:
        InputError: no object, an unknown or missing name, a value of another kind.
    """
    check.require(isinstance(table, dict), thing, "must be an object", type(table).__name__, "send one")
    for name in table:
        if name not in (*required, *optional):
            check.fail(
                thing,
                "must hold known names",
                repr(name)[:40],
                check.nearest_name(name, (*required, *optional)),
            )
    for name in required:
        check.require(name in table, thing, f"needs {name}", "none", "send it")
    return {name: _READERS[name](value, f"{thing}, {name}") for name, value in table.items()}


def _number(value: Any, thing: str) -> float:
    check.require(is_number(value), thing, "must be a number", repr(value)[:40], "send one")
    return float(value)


def _optional_number(value: Any, thing: str) -> float | None:
    return None if value is None else _number(value, thing)


def _whole(value: Any, thing: str) -> int:
    whole = isinstance(value, int) and not isinstance(value, bool)
    check.require(whole, thing, "must be a whole number", repr(value)[:40], "send one")
    return int(value)


def _wholes(value: Any, thing: str) -> tuple[int, ...]:
    check.require(
        isinstance(value, list), thing, "must be a list of whole numbers", repr(value)[:40], "send one"
    )
    return tuple(_whole(item, thing) for item in value)


def _texts(value: Any, thing: str) -> tuple[str, ...]:
    check.require(
        isinstance(value, list | tuple), thing, "must be a list of texts", repr(value)[:40], "send one"
    )
    return tuple(_text(item, thing) for item in value)


def _text(value: Any, thing: str) -> str:
    check.require(
        isinstance(value, str) and len(value) <= 300, thing, "must be a text", repr(value)[:40], "send one"
    )
    return str(value)


def _optional_text(value: Any, thing: str) -> str | None:
    return None if value is None else _text(value, thing)


def _flag(value: Any, thing: str) -> bool:
    check.require(isinstance(value, bool), thing, "must be true or false", repr(value)[:40], "send one")
    return bool(value)


def _point(value: Any, thing: str) -> Point:
    check.require(is_pair(value), thing, "must be a place [x, y]", repr(value)[:40], "send two numbers")
    return float(value[0]), float(value[1])


def _optional_point(value: Any, thing: str) -> Point | None:
    return None if value is None else _point(value, thing)


def _points(value: Any, thing: str) -> Points:
    check.require(
        isinstance(value, list), thing, "must be places [[x, y], …]", repr(value)[:40], "send a list"
    )
    return tuple(_point(item, thing) for item in value)


def _anything(value: Any, thing: str) -> Any:
    """A place, a number, a text or a list: what it may be is checked where it is used."""
    if isinstance(value, list):
        return tuple(_anything(item, thing) for item in value)
    plain = value is None or isinstance(value, str | bool) or is_number(value)
    check.require(plain, thing, "must be a number, a text or a list", repr(value)[:40], "send such")
    return value


_READERS: dict[str, Callable[[Any, str], Any]] = {
    "photo": _whole,
    "place": _text,
    "yaw": _optional_number,
    "foot": _optional_point,
    "top": _optional_number,
    "fork": _optional_point,
    "roll": _optional_number,
    "distance": _optional_number,
    "focal_length": _optional_number,
    "seeds": _points,
    "name": _text,
    "value": _anything,
    "points": _points,
    "label": _text,
    "width": _optional_number,
    "snapped": _flag,
    "indices": _wholes,
    "tree": _texts,
    "background": _texts,
    "index": _whole,
    "kind": _text,
    "softness": _number,
    "strength": _number,
    "height": _optional_number,
    "seed": _whole,
    "section": _optional_text,
}
