"""SVG path data as polylines."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

_NUMBER = re.compile(r"[\s,]*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)")
_FLAG = re.compile(r"[\s,]*([01])")
_COMMAND = re.compile(r"[\s,]*([MmLlHhVvCcSsQqTtAaZz])")
_REST = re.compile(r"[\s,]*$")
_NEEDS = {"M": 2, "L": 2, "H": 1, "V": 1, "C": 6, "S": 4, "Q": 4, "T": 2, "A": 7, "Z": 0}
_MOST_PIECES = 500  # of one curve

_Array = NDArray[np.float64]


@dataclass
class _Pen:
    """Where the pen is, and what it has drawn."""

    tolerance: float
    at: _Array = field(default_factory=lambda: np.zeros(2))
    start: _Array = field(default_factory=lambda: np.zeros(2))
    control: _Array | None = None  # the last control point, for the smooth commands
    before: str = ""  # the last command, upper case
    lines: list[list[_Array]] = field(default_factory=list)

    def move(self, to: _Array) -> None:
        self.at = self.start = to
        self.lines.append([to])

    def draw(self, points: _Array) -> None:
        if not self.lines or (self.before == "Z" and len(self.lines[-1]) > 0):
            self.lines.append([self.at])  # after a close, drawing goes on from the closed shape's start
        self.lines[-1].extend(points)
        self.at = points[-1]


def flatten_path(data: str, tolerance: float) -> list[_Array]:
    """The subpaths of SVG path data (M L H V C S Q T A Z, absolute and relative) as polylines.

    Args:
        data: the attribute ``d``.
        tolerance: how far a polyline may lie from its curve, in the path's units.

    Returns: polylines (k, 2), k >= 2; a subpath that only moves is left out.

    Raises:
        ValueError: what does not follow the grammar, with the place.
    """
    pen = _Pen(tolerance)
    place = 0
    while not _REST.match(data, place):
        found = _COMMAND.match(data, place)
        if found is None:
            raise ValueError(f"unexpected {data[place : place + 12]!r} at character {place}")
        command, place = found[1], found.end()
        if not pen.before and command.upper() != "M":
            raise ValueError(f"path data starts with {command!r} instead of a move")
        count = 0
        while command.upper() != "Z" and (count == 0 or _NUMBER.match(data, place)):
            values, place = _arguments(data, place, command.upper())
            # Further pairs after a move are lines.
            step = command if count == 0 or command not in "Mm" else ("L" if command == "M" else "l")
            _run(pen, step, values)
            count += 1
        if command.upper() == "Z":
            if not np.array_equal(pen.at, pen.start):
                pen.draw(pen.start[None, :])
            pen.at = pen.start
            pen.control, pen.before = None, "Z"
    return [np.array(line) for line in pen.lines if len(line) > 1]


def _arguments(data: str, place: int, command: str) -> tuple[list[float], int]:
    values = []
    for k in range(_NEEDS[command]):
        found = (_FLAG if command == "A" and k in (3, 4) else _NUMBER).match(data, place)
        if found is None:
            raise ValueError(f"{command} needs {_NEEDS[command]} numbers at character {place}")
        values.append(float(found[1]))
        place = found.end()
    if not np.isfinite(values).all():
        raise ValueError(f"a number too large before character {place}")
    return values, place


def _run(pen: _Pen, command: str, values: list[float]) -> None:
    kind = command.upper()
    origin = pen.at if command.islower() else np.zeros(2)
    control = None
    if kind == "H":
        pen.draw(np.array([[values[0] + origin[0], pen.at[1]]]))
    elif kind == "V":
        pen.draw(np.array([[pen.at[0], values[0] + origin[1]]]))
    elif kind == "A":
        end = np.array(values[5:]) + origin
        pen.draw(
            _arc(pen.at, end, values[0], values[1], values[2], values[3] > 0, values[4] > 0, pen.tolerance)
        )
    else:
        points = np.array(values).reshape(-1, 2) + origin
        if kind == "M":
            pen.move(points[0])
        elif kind == "L":
            pen.draw(points)
        else:
            smooth = kind in "ST"
            kin = "CS" if kind in "CS" else "QT"
            if smooth:
                known = pen.control is not None and pen.before in kin
                mirrored = 2.0 * pen.at - pen.control if known and pen.control is not None else pen.at
                points = np.concatenate([mirrored[None, :], points])
            control = points[-2]
            pen.draw(_bezier(np.concatenate([pen.at[None, :], points]), pen.tolerance))
    pen.control, pen.before = control, kind


def _bezier(points: _Array, tolerance: float) -> _Array:
    """Points after the first of a Bézier curve; the error is at most h²/8 of its second derivative."""
    degree = len(points) - 1
    bend = np.linalg.norm(np.diff(points, n=2, axis=0), axis=1).max() * degree * (degree - 1)
    pieces = int(np.clip(np.ceil(np.sqrt(bend / (8.0 * tolerance))), 1, _MOST_PIECES))
    t = np.linspace(0.0, 1.0, pieces + 1)[1:, None]
    if degree == 2:
        curve = (1 - t) ** 2 * points[0] + 2 * t * (1 - t) * points[1] + t**2 * points[2]
    else:
        curve = (1 - t) ** 3 * points[0] + 3 * t * (1 - t) ** 2 * points[1]
        curve = curve + 3 * t**2 * (1 - t) * points[2] + t**3 * points[3]
    curve[-1] = points[-1]
    return np.asarray(curve)


def _arc(
    start: _Array, end: _Array, rx: float, ry: float, turn: float, large: bool, sweep: bool, tolerance: float
) -> _Array:
    """Points after the first of an elliptical arc (SVG 1.1, appendix F.6)."""
    rx, ry = abs(rx), abs(ry)
    if rx == 0.0 or ry == 0.0 or np.array_equal(start, end):
        return end[None, :]
    c, s = np.cos(np.radians(turn)), np.sin(np.radians(turn))
    rotation = np.array([[c, s], [-s, c]])
    x, y = rotation @ (start - end) / 2.0
    spread = (x / rx) ** 2 + (y / ry) ** 2
    if spread > 1.0:  # radii too small to reach: enlarged just enough
        rx, ry = rx * np.sqrt(spread), ry * np.sqrt(spread)
        spread = 1.0
    root = np.sqrt(max(0.0, 1.0 / spread - 1.0)) * (-1.0 if large == sweep else 1.0)
    cx, cy = root * rx * y / ry, -root * ry * x / rx
    first = np.arctan2((y - cy) / ry, (x - cx) / rx)
    angle = np.arctan2((-y - cy) / ry, (-x - cx) / rx) - first
    if sweep and angle < 0.0:
        angle += 2.0 * np.pi
    if not sweep and angle > 0.0:
        angle -= 2.0 * np.pi
    step = np.sqrt(8.0 * tolerance / max(rx, ry))
    pieces = int(np.clip(np.ceil(abs(angle) / step), 4, _MOST_PIECES))
    t = first + angle * np.arange(1, pieces + 1) / pieces
    curve = np.stack([cx + rx * np.cos(t), cy + ry * np.sin(t)], axis=1) @ rotation + (start + end) / 2.0
    curve[-1] = end
    return np.asarray(curve)
