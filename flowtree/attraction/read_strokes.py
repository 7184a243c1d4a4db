"""Reads drawn branches: optional attractors (Particle Flows, section 4)."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from flowtree import check
from flowtree.attraction.read_drawing import read_drawing
from flowtree.geometry.polylines import drop_repeats
from flowtree.model.photo import Photo


def read_strokes(path: str | Path, photo: Photo) -> tuple[NDArray[np.float32], ...]:
    """Reads strokes from an SVG, JSON or PNG file, told apart by the file's ending.

    SVG: path, polyline, polygon and line elements with all transforms. A viewBox is mapped to the picture;
    without one the units are pixels of the upright original photo. JSON: ``{"strokes": [{"points": [[x, y],
    …], "width": w}, …]}``, the width where a brush was used, or bare ``[[[x, y], …], …]`` in those pixels;
    the first form may hold marks (`ViewMarks`) beside the strokes or instead of them. PNG: of the photo's
    aspect, any size; opaque pixels on a transparent or coloured and dark ones on a white ground, thinned to
    lines.

    Args:
        path: the file.
        photo: the photo it belongs to.

    Returns: polylines (k, 2) float32 as (x, y) [working pixels], those of a brush (k, 3) with its width, k >=
        2, none wholly outside the picture; nothing for a JSON file of marks alone.

    Raises:
        InputError: no such file, another ending, malformed, without a stroke, a stroke wholly outside.
    """
    file = Path(path)
    high, wide = photo.rgb.shape[:2]
    drawn = read_drawing(file, (photo.name, wide / photo.scale, high / photo.scale))
    if drawn is None:
        return ()
    lines = [drop_repeats(line * photo.scale) for line in drawn]
    lines = [line for line in lines if len(line) > 1]
    check.require(len(lines) > 0, file.name, "needs at least one stroke", "none", "draw a line")
    for number, line in enumerate(lines):
        low, top = line[:, :2].min(axis=0), line[:, :2].max(axis=0)
        outside = bool((top < 0.0).any() or (low > (wide, high)).any())
        check.require(
            not outside,
            f"{file.name}, stroke {number}",
            f"must touch the photo ({wide / photo.scale:.0f} x {high / photo.scale:.0f})",
            f"points from {(low / photo.scale).round(1).tolist()} to {(top / photo.scale).round(1).tolist()}",
            "give it in pixels of the upright photo",
        )
    return tuple(line.astype(np.float32) for line in lines)
