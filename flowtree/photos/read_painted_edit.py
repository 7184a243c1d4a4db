"""Reads what a person painted over a photo: density added or erased, directions changed."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from flowtree import check
from flowtree.model.edit import PaintedEdit
from flowtree.model.photo import Photo
from flowtree.params import PhotoParams
from flowtree.photos.decode_picture import decode_picture
from flowtree.photos.read_trimap import require_aspect

_KINDS = ("add", "erase", "direct")
_LARGEST_FILE = 64_000_000  # bytes of JSON
_FARTHEST = 1e9  # pixels; also refuses NaN, infinity and whole numbers no float can hold
_SUBPIXEL = 4  # fractional bits of cv2's drawing
_SOFT = 0.5  # share of the brush's radius over which it fades, where nothing is said
_HARDEST = 1e-3  # of the same
_LAYERS = '{"layers": [{"kind": "add", "width": 40, "strength": 0.8, "points": [[x, y], …]}, …]}'


def read_painted_edit(path: str | Path, photo: Photo, *, params: PhotoParams = PhotoParams()) -> PaintedEdit:
    """Reads a painted edit from a picture or, where the file's name ends in ``.json``, from JSON.

    A picture has the photo's aspect (any size). Green adds density, red erases it, other colours say
    nothing; the pixel's alpha is the strength, 1 where there is no alpha channel.

    JSON is ``{"layers": [{"kind": "add", "width": 40, "strength": 0.8, "points": [[x, y], …]}, …]}``; width
    and points are in pixels of the upright original photo, (0, 0) its upper left corner. "add" and "erase"
    are strokes of a round brush that fades over the outer ``"softness"``, 0 to 1, of its radius, one half if
    left out; the strength, 0 to 1, is 1 if left out. "direct" makes particles within ``width`` of the stroke
    flow along it, from its first point to its last.

    Args:
        path: the file.
        photo: the photo it belongs to.
        params: the cap on pixels.

    Returns: layers of the photo's working size, directions in its pixels.

    Raises:
        InputError: no such file, malformed, another aspect than the photo's, a stroke wholly outside the
        photo,
            nothing painted.
    """
    file = Path(path)
    edit = _from_json(file, photo) if file.suffix.lower() == ".json" else _from_picture(file, photo, params)
    layers = [layer for layer in (edit.add, edit.erase) if layer is not None]
    painted = len(edit.directions) > 0 or any(bool(layer.any()) for layer in layers)
    check.require(
        painted, file.name, "needs something painted", "nothing", "paint in green (add) or red (erase)"
    )
    return edit


def _from_picture(file: Path, photo: Photo, params: PhotoParams) -> PaintedEdit:
    picture = decode_picture(file, side=None, params=params)
    require_aspect(file.name, picture.rgb.shape[:2], photo)
    red, green, blue = (picture.rgb[..., k].astype(np.int16) for k in range(3))
    opaque = np.ones(red.shape, np.float32)
    strength = opaque if picture.alpha is None else picture.alpha.astype(np.float32) / np.float32(255.0)
    height, width = photo.rgb.shape[:2]
    shrinks = width <= red.shape[1]
    method = cv2.INTER_AREA if shrinks else cv2.INTER_LINEAR
    layers: list[NDArray[np.float32] | None] = []
    for wanted, other in ((green, red), (red, green)):
        layer = np.where((wanted > other + 64) & (wanted > blue + 64), strength, np.float32(0.0))
        scaled = np.clip(cv2.resize(layer, (width, height), interpolation=method), 0.0, 1.0)
        layers.append(scaled.astype(np.float32) if scaled.any() else None)
    return PaintedEdit(add=layers[0], erase=layers[1])


def _from_json(file: Path, photo: Photo) -> PaintedEdit:
    check.require(file.is_file(), file.name, "must be a painted edit", "no such file", "check the path")
    size = file.stat().st_size
    check.require(size <= _LARGEST_FILE, file.name, "must be under 64 MB", f"{size} bytes", "paint less")
    try:
        content = json.loads(file.read_text(encoding="utf-8"))
    except (ValueError, RecursionError) as error:
        check.fail(file.name, "must be JSON", f"something else ({error})", f"write {_LAYERS}")
    listed = isinstance(content, dict) and isinstance(content.get("layers"), list)
    check.require(listed, file.name, 'must hold a list "layers"', type(content).__name__, f"write {_LAYERS}")
    painted: dict[str, NDArray[np.float32]] = {}
    directions, reach = [], []
    for number, layer in enumerate(content["layers"]):
        name = f"{file.name}, layer {number}"
        kind, width, strength, softness, line = _parse_layer(layer, name, photo)
        if kind == "direct":
            directions.append(line.astype(np.float32))
            reach.append(width)
        elif strength > 0.0:
            before = painted.setdefault(kind, np.zeros(photo.rgb.shape[:2], np.float32))
            cover = np.float32(strength) * _brush(line, width, softness, before.shape)
            painted[kind] = (before + cover - before * cover).astype(np.float32)
    return PaintedEdit(painted.get("add"), painted.get("erase"), tuple(directions), tuple(reach))


def _parse_layer(layer: Any, name: str, photo: Photo) -> tuple[str, float, float, float, NDArray[np.float64]]:
    """Kind, width [working pixels], strength, softness and points (n, 2) [working pixels] of one layer."""
    check.require(
        isinstance(layer, dict), name, "must be an object", type(layer).__name__, f"write {_LAYERS}"
    )
    kind, points = layer.get("kind"), layer.get("points")
    width, strength, softness = layer.get("width", 40), layer.get("strength", 1), layer.get("softness", _SOFT)
    known = isinstance(kind, str) and kind in _KINDS
    check.require(known, name, f"needs a kind ({', '.join(_KINDS)})", repr(kind)[:40], "name one of them")
    widest = (photo.rgb.shape[0] + photo.rgb.shape[1]) / photo.scale
    wide = _is_number(width) and 0 < width <= widest
    check.require(wide, name, f"needs a width from 0 to {widest:.0f}", repr(width)[:40], "give it in pixels")
    strong = _is_number(strength) and 0 <= strength <= 1
    check.require(strong, name, "needs a strength from 0 to 1", repr(strength)[:40], "give a share")
    soft = _is_number(softness) and 0 <= softness <= 1
    check.require(soft, name, "needs a softness from 0 to 1", repr(softness)[:40], "give a share")
    pairs = isinstance(points, list) and len(points) > 0 and all(_is_pair(point) for point in points)
    check.require(
        pairs, name, "needs points [[x, y], …]", repr(points)[:40], "list at least one pair of numbers"
    )
    line = np.asarray(points, np.float64) * photo.scale
    if kind == "direct":
        moves = bool((np.abs(np.diff(line, axis=0)).max(axis=1, initial=0.0) > 0.0).any())
        check.require(moves, name, "needs two different points", f"{len(line)}", "draw it longer")
    high, across = photo.rgb.shape[:2]
    apart = (line.max(axis=0) < 0.0).any() or (line.min(axis=0) > (across, high)).any()
    check.require(
        not apart,
        name,
        f"must touch the photo ({across / photo.scale:.0f} x {high / photo.scale:.0f})",
        f"points from {np.min(points, axis=0).tolist()} to {np.max(points, axis=0).tolist()}",
        "give them in pixels of the upright photo",
    )
    return str(kind), float(width) * photo.scale, float(strength), float(softness), line


def _brush(
    line: NDArray[np.float64], width: float, softness: float, shape: tuple[int, ...]
) -> NDArray[np.float32]:
    """The cover (h, w) of a round brush drawn along a line: 1 inside, falling to 0 at its rim."""
    # Drawing is in 32-bit fixed point: what lies far out must not wrap around.
    far = 4.0 * sum(shape)
    line = np.concatenate([line, line[-1:]])  # a line of one point draws nothing, one to itself a dot
    fixed = np.rint((np.clip(line, -far, far) - 0.5) * 2**_SUBPIXEL).astype(np.int32).reshape(-1, 1, 2)
    spine = np.ones(shape, np.uint8)
    cv2.polylines(spine, [fixed], False, 0, thickness=1, shift=_SUBPIXEL)
    if spine.all():  # the brush's middle stays outside the picture
        return np.zeros(shape, np.float32)
    distance = cv2.distanceTransform(spine, cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
    # Half a pixel more: a brush narrower than a pixel still leaves a trace.
    away = (distance - 0.5) / max(0.5 * width, 0.5)
    soft = max(softness, _HARDEST)
    fade = np.clip((away - (1.0 - soft)) / soft, 0.0, 1.0)
    return np.asarray(1.0 - fade * fade * (3.0 - 2.0 * fade), np.float32)


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and abs(value) <= _FARTHEST


def _is_pair(value: Any) -> bool:
    return isinstance(value, list) and len(value) == 2 and all(_is_number(number) for number in value)
