"""Reads drawn lines from a file of any of the three kinds."""

from __future__ import annotations

import json
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from flowtree import check
from flowtree.attraction.parse_svg_lines import parse_svg_lines
from flowtree.attraction.trace_drawn_pixels import trace_drawn_pixels
from flowtree.model.marks import ViewMarks

_LARGEST_FILE = 64_000_000  # bytes
_MOST_PIXELS = 89_000_000
_LARGEST_SIDE = 1500  # pixels: larger drawings are scaled down before they are thinned
_MOST_DRAWN = 0.3  # share of a picture: more is no drawing of lines
_ASPECT = 0.02  # how far a drawing's aspect may differ from its frame's
_FARTHEST = 1e9  # pixels; also refuses NaN, infinity and whole numbers no float can hold
_STROKES = '{"strokes": [{"points": [[x, y], …]}, …]}'
_MARKS = tuple(field.name for field in fields(ViewMarks))

_Lines = list[NDArray[np.float64]]
_Frame = tuple[str, float, float] | None


def read_drawing(file: Path, frame: _Frame = None) -> _Lines | None:
    """The lines of an SVG, JSON or PNG file, told apart by the file's ending.

    SVG: path, polyline, polygon and line elements with all transforms; a viewBox is mapped to the frame.
    JSON: ``{"strokes": [{"points": [[x, y], …], "width": w}, …]}``, the width where a brush was used, or bare
    ``[[[x, y], …], …]``. PNG: opaque pixels on a transparent or coloured and dark ones on a white ground,
    thinned to lines.

    Args:
        file: the file.
        frame: name, width and height [pixels] of the picture that the drawing lies on, whose aspect a PNG
            must have; None leaves the drawing in its own units.

    Returns: polylines (k, 2) as (x, y), y downwards, those of a brush (k, 3) with its width; None for a JSON
        file of marks (`ViewMarks`) alone.

    Raises:
        InputError: no such file, another ending, malformed, too large, a picture drawn over.
    """
    readers = {".svg": _read_svg, ".json": _read_json, ".png": _read_png}
    ending = file.suffix.lower()
    known = ending in readers
    check.require(known, file.name, "must end in .svg, .json or .png", repr(ending), "export it anew")
    check.require(file.is_file(), file.name, "must be a file of strokes", "no such file", "check the path")
    size = file.stat().st_size
    check.require(size <= _LARGEST_FILE, file.name, "must be under 64 MB", f"{size} bytes", "draw less")
    return readers[ending](file, frame)


def _read_svg(file: Path, frame: _Frame) -> _Lines:
    try:
        lines, box = parse_svg_lines(file.read_text(encoding="utf-8-sig"))
    except ValueError as error:
        check.fail(file.name, "must be an SVG drawing", str(error), "export it as plain SVG")
    if box is None or frame is None:
        return lines
    stretch = np.array(frame[1:]) / box[2:]
    return [(line - box[:2]) * stretch for line in lines]


def _read_json(file: Path, frame: _Frame) -> _Lines | None:
    """The lines, or None for a file of marks alone."""
    del frame  # the points are in its pixels already
    try:
        content = json.loads(file.read_text(encoding="utf-8-sig"))
    except (ValueError, RecursionError) as error:
        check.fail(file.name, "must be JSON", f"something else ({error})", f"write {_STROKES}")
    strokes: Any = content.get("strokes") if isinstance(content, dict) else content
    if strokes in (None, []) and isinstance(content, dict):
        marked = any(content.get(mark) not in (None, []) for mark in _MARKS)
        if marked:
            return None
    listed = isinstance(strokes, list)
    kind = type(strokes).__name__
    check.require(listed, file.name, "must hold a list of strokes", kind, f"write {_STROKES}")
    lines = []
    for number, stroke in enumerate(strokes):
        points = stroke.get("points") if isinstance(stroke, dict) else stroke
        pairs = isinstance(points, list) and len(points) > 1 and all(_is_pair(point) for point in points)
        check.require(
            pairs,
            f"{file.name}, stroke {number}",
            "needs at least two points [[x, y], …]",
            repr(points)[:40],
            "list pairs of numbers",
        )
        line = np.array(points, np.float64)
        width = stroke.get("width") if isinstance(stroke, dict) else None
        if width is not None:
            wide = _is_number(width) and width > 0
            got = repr(width)[:40]
            check.require(wide, f"{file.name}, stroke {number}", "needs a width above 0", got, "leave it out")
            line = np.column_stack([line, np.full(len(line), float(width))])
        lines.append(line)
    return lines


def _png_size(file: Path) -> tuple[int, int]:
    """Width and height [pixels] that the file's header names; 0 where it has none."""
    with file.open("rb") as opened:
        header = opened.read(24)
    return int.from_bytes(header[16:20], "big"), int.from_bytes(header[20:24], "big")


def _read_png(file: Path, frame: _Frame) -> _Lines:
    # Pillow only warns of such, and whether it does is a setting of the whole process.
    across, down = _png_size(file)
    large = across * down > _MOST_PIXELS
    check.require(
        not large, file.name, "must have at most 89 megapixels", f"{across} x {down}", "scale it down"
    )
    try:
        with Image.open(file, formats=["PNG"]) as picture:
            pixels = np.asarray(picture.convert("RGBA"))
    except Exception as error:  # a decoder raises whatever it stumbles over in damaged data
        check.fail(file.name, "must be a whole PNG picture", str(error), "export it again")
    down, across = pixels.shape[:2]
    factor = min(1.0, _LARGEST_SIDE / max(across, down))
    size = (max(1, round(across * factor)), max(1, round(down * factor)))
    cover = Image.fromarray(_drawn(pixels)).resize(size, Image.Resampling.BOX)
    name, wide, high = (file.name, across, down) if frame is None else frame
    slack = max(_ASPECT * across * high, high + wide, across + down)
    check.require(
        abs(across * high - down * wide) <= slack,
        file.name,
        f"must have the aspect of {name} ({wide:.0f} x {high:.0f})",
        f"{across} x {down}",
        "export it at the size of the upright photo",
    )
    drawn = np.asarray(cover) > 64
    share = float(drawn.mean())
    check.require(
        share <= _MOST_DRAWN,
        file.name,
        "must be thin lines on a transparent or white ground",
        f"a picture drawn over to {100 * share:.0f} %",
        "export the drawing without the photo",
    )
    stretch = np.array([wide, high]) / size
    return [line * stretch for line in trace_drawn_pixels(drawn)]


def _drawn(pixels: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """255 where a picture (h, w, 4) is drawn on: opaque on transparent, else anything but white."""
    alpha = pixels[..., 3]
    if alpha.min() < 128:
        return np.where(alpha >= 128, 255, 0).astype(np.uint8)
    return np.where(pixels[..., :3].min(axis=2) < 200, 255, 0).astype(np.uint8)


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and abs(value) <= _FARTHEST


def _is_pair(value: Any) -> bool:
    return isinstance(value, list) and len(value) == 2 and all(_is_number(number) for number in value)
