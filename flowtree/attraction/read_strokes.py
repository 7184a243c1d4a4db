"""Reads drawn branches: optional attractors (Particle Flows, section 4)."""

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
from flowtree.geometry.polylines import drop_repeats
from flowtree.model.marks import ViewMarks
from flowtree.model.photo import Photo

_LARGEST_FILE = 64_000_000  # bytes
_MOST_PIXELS = 89_000_000
_LARGEST_SIDE = 1500  # pixels: larger drawings are scaled down before they are thinned
_MOST_DRAWN = 0.3  # share of a picture: more is no drawing of lines
_ASPECT = 0.02  # how far a drawing's aspect may differ from the photo's
_FARTHEST = 1e9  # pixels; also refuses NaN, infinity and whole numbers no float can hold
_STROKES = '{"strokes": [{"points": [[x, y], …]}, …]}'
_MARKS = tuple(field.name for field in fields(ViewMarks))

_Lines = list[NDArray[np.float64]]


def read_strokes(path: str | Path, photo: Photo) -> tuple[NDArray[np.float32], ...]:
    """Reads strokes from an SVG, JSON or PNG file, told apart by the file's ending.

    SVG: path, polyline, polygon and line elements with all transforms. A viewBox is mapped to the picture;
    without one the units are pixels of the upright original photo. JSON: ``{"strokes": [{"points": [[x, y],
    …]}, …]}`` or bare ``[[[x, y], …], …]`` in those pixels; the first form may hold marks (`ViewMarks`)
    beside the strokes or instead of them. PNG: of the photo's aspect, any size; opaque pixels on a
    transparent or coloured and dark ones on a white ground, thinned to lines.

    Args:
        path: the file.
        photo: the photo it belongs to.

    Returns: polylines (k, 2) float32 as (x, y) [working pixels], k >= 2, none wholly outside the picture;
        nothing for a JSON file of marks alone.

    Raises:
        InputError: no such file, another ending, malformed, without a stroke, a stroke wholly outside.
    """
    file = Path(path)
    readers = {".svg": _read_svg, ".json": _read_json, ".png": _read_png}
    ending = file.suffix.lower()
    known = ending in readers
    check.require(known, file.name, "must end in .svg, .json or .png", repr(ending), "export it anew")
    check.require(file.is_file(), file.name, "must be a file of strokes", "no such file", "check the path")
    size = file.stat().st_size
    check.require(size <= _LARGEST_FILE, file.name, "must be under 64 MB", f"{size} bytes", "draw less")
    drawn = readers[ending](file, photo)
    if drawn is None:
        return ()
    lines = [drop_repeats(line * photo.scale) for line in drawn]
    lines = [line for line in lines if len(line) > 1]
    check.require(len(lines) > 0, file.name, "needs at least one stroke", "none", "draw a line")
    high, wide = photo.rgb.shape[:2]
    for number, line in enumerate(lines):
        low, top = line.min(axis=0), line.max(axis=0)
        outside = bool((top < 0.0).any() or (low > (wide, high)).any())
        check.require(
            not outside,
            f"{file.name}, stroke {number}",
            f"must touch the photo ({wide / photo.scale:.0f} x {high / photo.scale:.0f})",
            f"points from {(low / photo.scale).round(1).tolist()} to {(top / photo.scale).round(1).tolist()}",
            "give it in pixels of the upright photo",
        )
    return tuple(line.astype(np.float32) for line in lines)


def _read_svg(file: Path, photo: Photo) -> _Lines:
    try:
        lines, box = parse_svg_lines(file.read_text(encoding="utf-8-sig"))
    except ValueError as error:
        check.fail(file.name, "must be an SVG drawing", str(error), "export it as plain SVG")
    if box is None:
        return lines
    high, wide = photo.rgb.shape[:2]
    stretch = np.array([wide, high]) / photo.scale / box[2:]
    return [(line - box[:2]) * stretch for line in lines]


def _read_json(file: Path, photo: Photo) -> _Lines | None:
    """The lines, or None for a file of marks alone."""
    del photo  # the points are in its pixels already
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
        lines.append(np.array(points, np.float64))
    return lines


def _png_size(file: Path) -> tuple[int, int]:
    """Width and height [pixels] that the file's header names; 0 where it has none."""
    with file.open("rb") as opened:
        header = opened.read(24)
    return int.from_bytes(header[16:20], "big"), int.from_bytes(header[20:24], "big")


def _read_png(file: Path, photo: Photo) -> _Lines:
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
    high, wide = photo.rgb.shape[:2]
    slack = max(_ASPECT * across * high, high + wide, across + down)
    check.require(
        abs(across * high - down * wide) <= slack,
        file.name,
        f"must have the aspect of {photo.name} ({wide} x {high})",
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
    stretch = np.array([wide, high]) / photo.scale / size
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
