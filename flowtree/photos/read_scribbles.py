"""Reads scribbles that say what is tree and what is not."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from flowtree import check
from flowtree.model.photo import Photo
from flowtree.params import PhotoParams
from flowtree.photos.decode_picture import decode_picture
from flowtree.photos.read_drawn_json import is_number, is_pair, read_drawn_json
from flowtree.photos.read_trimap import require_aspect

_LABELS = {"tree": 1, "background": 2, "occluder": 3, "unknown": 4}
_SUBPIXEL = 4  # fractional bits of cv2's drawing
_STROKES = '{"strokes": [{"label": "tree", "width": 8, "points": [[x, y], …]}, …]}'


def read_scribbles(
    path: str | Path, photo: Photo, *, params: PhotoParams = PhotoParams()
) -> NDArray[np.uint8]:
    """Reads scribbles from a picture or, where the file's name ends in ``.json``, from JSON.

    A picture has the photo's aspect (any size). Green or white is tree, red or black is background, blue is
    something that stands before the tree (a lamp post, a car): not background, but unknown; a transparent
    pixel (alpha below one half), or any other grey, says nothing. Where strokes are finer than the photo's
    pixels, the label that covers most of a pixel counts.

    JSON is ``{"strokes": [{"label": "tree", "width": 8, "points": [[x, y], …]}, …]}`` with the labels "tree",
    "background", "occluder" and "unknown", where the pixels shall decide and no judgement of ours; width and
    points are in pixels of the upright original photo, (0, 0) its upper left corner. A stroke of one point is
    a dot; a later stroke covers an earlier one. A stroke may leave the picture, but not lie wholly outside
    it.

    Args:
        path: the file.
        photo: the photo it belongs to.
        params: the cap on pixels.

    Returns:
        (h, w) uint8 of the photo's size: 0 nothing, 1 tree, 2 background, 3 an occluder, 4 unknown.

    Raises:
        InputError: no such file, malformed, another aspect than the photo's, a stroke outside, no stroke.
    """
    file = Path(path)
    labels = _from_json(file, photo) if file.suffix.lower() == ".json" else _from_picture(file, photo, params)
    drawn = bool(labels.any())
    check.require(drawn, file.name, "needs at least one stroke", "none", "draw on the tree or beside it")
    return labels


def _from_picture(file: Path, photo: Photo, params: PhotoParams) -> NDArray[np.uint8]:
    picture = decode_picture(file, side=None, params=params)
    require_aspect(file.name, picture.rgb.shape[:2], photo)
    red, green, blue = (picture.rgb[..., k].astype(np.int16) for k in range(3))
    opaque = np.ones(red.shape, bool) if picture.alpha is None else picture.alpha >= 128
    brightest = np.maximum(np.maximum(red, green), blue)
    darkest = np.minimum(np.minimum(red, green), blue)
    grey = brightest - darkest < 32
    tree = ((green > red + 64) & (green > blue + 64)) | (grey & (darkest > 224))
    background = ((red > green + 64) & (red > blue + 64)) | (grey & (brightest < 32))
    unknown = (blue > red + 64) & (blue > green + 64)
    strange = opaque & ~(tree | background | unknown | grey)
    check.require(
        2 * int(strange.sum()) <= int(opaque.sum()),
        file.name,
        "must be drawn in green or white (tree), red or black (background) and blue (occluder)",
        "mostly other colours",
        "draw on a transparent layer in those colours",
    )
    height, width = photo.rgb.shape[:2]
    cover: NDArray[Any] = np.stack(
        [(mask & opaque).astype(np.float32) for mask in (tree, background, unknown)], axis=2
    )
    shrinks = width <= cover.shape[1]
    cover = cv2.resize(cover, (width, height), interpolation=cv2.INTER_AREA if shrinks else cv2.INTER_NEAREST)
    labels: NDArray[np.uint8] = (np.argmax(cover, axis=2) + 1).astype(np.uint8)
    labels[cover.max(axis=2) < 1.0 / 32.0] = 0
    return labels


def _from_json(file: Path, photo: Photo) -> NDArray[np.uint8]:
    content = read_drawn_json(file, holds="scribbles", form=_STROKES)
    listed = isinstance(content, dict) and isinstance(content.get("strokes"), list)
    check.require(
        listed, file.name, 'must hold a list "strokes"', type(content).__name__, f"write {_STROKES}"
    )
    labels = np.zeros(photo.rgb.shape[:2], np.uint8)
    for number, stroke in enumerate(content["strokes"]):
        _draw(labels, stroke, f"{file.name}, stroke {number}", photo)
    return labels


def _draw(labels: NDArray[np.uint8], stroke: Any, name: str, photo: Photo) -> None:
    """Draws one stroke of the JSON into the labels."""
    check.require(
        isinstance(stroke, dict), name, "must be an object", type(stroke).__name__, f"write {_STROKES}"
    )
    label, width, points = stroke.get("label"), stroke.get("width", 8), stroke.get("points")
    known = isinstance(label, str) and label in _LABELS
    check.require(known, name, f"needs a label ({', '.join(_LABELS)})", repr(label)[:40], "name one of them")
    height_px, width_px = photo.rgb.shape[:2]
    widest = (height_px + width_px) / photo.scale
    wide = is_number(width) and 0 < width <= widest
    check.require(wide, name, f"needs a width from 0 to {widest:.0f}", repr(width)[:40], "give it in pixels")
    pairs = isinstance(points, list) and len(points) > 0 and all(is_pair(point) for point in points)
    check.require(
        pairs, name, "needs points [[x, y], …]", repr(points)[:40], "list at least one pair of numbers"
    )
    drawn = np.asarray(points, np.float64)
    path = drawn * photo.scale
    # Drawing is in fixed point: what lies this far out could only wrap around.
    near = bool((np.abs(path) <= 100.0 * (height_px + width_px)).all())
    layer = np.zeros_like(labels)
    if near:
        fixed = np.rint((path - 0.5) * 2**_SUBPIXEL).astype(np.int32).reshape(-1, 1, 2)
        fixed = np.concatenate([fixed, fixed[-1:]])  # a single point is a dot, too
        thick = max(1, round(width * photo.scale))
        cv2.polylines(layer, [fixed], False, 1, thickness=thick, shift=_SUBPIXEL)
        # A thin stroke on the right or lower edge is rounded to pixels beyond it: its own pixels count, too.
        inside = path[((path >= 0.0) & (path <= (width_px, height_px))).all(axis=1)]
        column, row = np.minimum(inside.astype(int), (width_px - 1, height_px - 1)).T
        layer[row, column] = 1
    check.require(
        bool(layer.any()),
        name,
        f"must touch the photo ({width_px / photo.scale:.0f} x {height_px / photo.scale:.0f})",
        f"points from {drawn.min(axis=0).tolist()} to {drawn.max(axis=0).tolist()}",
        "give them in pixels of the upright photo",
    )
    labels[layer > 0] = _LABELS[str(label)]
