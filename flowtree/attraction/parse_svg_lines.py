"""The drawn lines of an SVG file."""

from __future__ import annotations

import re
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from flowtree.geometry.flatten_path import flatten_path

_TOLERANCE = 0.1  # of a curve's polyline [user units of the whole picture]
_HIDDEN = {
    "defs",
    "clipPath",
    "mask",
    "symbol",
    "marker",
    "pattern",
    "metadata",
}  # holds nothing that is drawn
_NUMBERS = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?")
_TRANSFORM = re.compile(r"[\s,]*(matrix|translate|scale|rotate|skewX|skewY)\s*\(([^()]*)\)")
_COUNTS = {
    "matrix": (6,), "translate": (1, 2), "scale": (1, 2), "rotate": (1, 3), "skewX": (1,), "skewY": (1,),
}  # fmt: skip

_Array = NDArray[np.float64]


def parse_svg_lines(text: str) -> tuple[list[_Array], tuple[float, float, float, float] | None]:
    """Reads path, polyline, polygon and line elements with the transforms of all groups around them.

    Args:
        text: of the file. A DOCTYPE is refused: its entities can blow a small file up without bound.

    Returns:
        Polylines (k, 2) in the outermost user units, and the viewBox (x, y, width, height) if there is one.

    Raises:
        ValueError: not XML, not SVG, a DOCTYPE, malformed path data, points, transform or viewBox.
    """
    if "<!doctype" in text.lower() or "<!entity" in text.lower():
        raise ValueError("a DOCTYPE, which is not allowed")
    try:
        root = ElementTree.fromstring(text)
    except ElementTree.ParseError as error:
        raise ValueError(f"malformed XML ({error})") from error
    if _name(root) != "svg":
        raise ValueError(f"XML whose outermost element is {_name(root)!r}")
    lines: list[_Array] = []
    waiting = [(root, np.eye(3))]
    while waiting:
        element, around = waiting.pop()
        if _name(element) in _HIDDEN:
            continue
        matrix = around @ _matrix(element.get("transform", ""))
        size = max(float(np.sqrt(abs(np.linalg.det(matrix[:2, :2])))), 1e-6)
        for line in _lines(element, _TOLERANCE / size):
            moved = line @ matrix[:2, :2].T + matrix[:2, 2]
            if not np.isfinite(moved).all():
                raise ValueError("numbers too large")
            lines.append(moved)
        waiting.extend((child, matrix) for child in reversed(element))
    return lines, _view_box(root.get("viewBox"))


def _name(element: ElementTree.Element) -> str:
    """The tag without its namespace; comments and processing instructions have none."""
    return element.tag.rpartition("}")[2] if isinstance(element.tag, str) else ""


def _lines(element: ElementTree.Element, tolerance: float) -> list[_Array]:
    kind = _name(element)
    if kind == "path":
        return flatten_path(element.get("d", ""), tolerance)
    if kind == "line":
        ends = [_length(element.get(key, "0")) for key in ("x1", "y1", "x2", "y2")]
        return [np.array(ends).reshape(2, 2)]
    if kind in ("polyline", "polygon"):
        numbers = _numbers(element.get("points", ""))
        if len(numbers) % 2:
            raise ValueError(f"{kind} points that are no pairs")
        points = np.array(numbers).reshape(-1, 2)
        if kind == "polygon":
            points = np.concatenate([points, points[:1]])
        return [points] if len(points) > 1 else []
    return []


def _length(text: str) -> float:
    number = _NUMBERS.fullmatch(text.strip().removesuffix("px").strip())
    if number is None:
        raise ValueError(f"the coordinate {text[:20]!r}")
    return float(number[0])


def _numbers(text: str) -> list[float]:
    if _NUMBERS.sub("", text).strip(" ,\t\r\n"):
        raise ValueError(f"the numbers {text[:20]!r}")
    return [float(number) for number in _NUMBERS.findall(text)]


def _view_box(text: str | None) -> tuple[float, float, float, float] | None:
    if text is None:
        return None
    numbers = _numbers(text)
    if len(numbers) != 4 or not np.isfinite(numbers).all() or min(numbers[2:]) <= 0.0:
        raise ValueError(f"the viewBox {text[:40]!r}")
    return (numbers[0], numbers[1], numbers[2], numbers[3])


def _matrix(text: str) -> _Array:
    """The 3 x 3 matrix of a transform list."""
    result = np.eye(3)
    place = 0
    while found := _TRANSFORM.match(text, place):
        kind, v = found[1], _numbers(found[2])
        if len(v) not in _COUNTS[kind]:
            raise ValueError(f"the transform {found[0].strip()[:40]!r}")
        result = result @ _transform(kind, v)
        place = found.end()
    if text[place:].strip(" ,\t\r\n"):
        raise ValueError(f"the transform {text[place:][:40]!r}")
    return result


def _transform(kind: str, v: list[float]) -> _Array:
    a, b, c, d, e, f = 1.0, 0.0, 0.0, 1.0, 0.0, 0.0
    if kind == "matrix":
        a, b, c, d, e, f = v
    elif kind == "translate":
        e, f = v[0], v[1] if len(v) > 1 else 0.0
    elif kind == "scale":
        a, d = v[0], v[-1]
    elif kind == "rotate":
        turn = np.radians(v[0])
        a, b, c, d = np.cos(turn), np.sin(turn), -np.sin(turn), np.cos(turn)
        if len(v) == 3:
            e, f = v[1] - a * v[1] - c * v[2], v[2] - b * v[1] - d * v[2]
    elif kind == "skewX":
        c = np.tan(np.radians(v[0]))
    else:
        b = np.tan(np.radians(v[0]))
    return np.array([[a, c, e], [b, d, f], [0.0, 0.0, 1.0]])
