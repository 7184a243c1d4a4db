"""Painted directions bend a direction field (Particle Flows, sections 1 and 10)."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from flowtree import check
from flowtree.geometry.polylines import drop_repeats, nearest_on_segments, subdivide_polyline
from flowtree.geometry.projection import pixels_to_plane
from flowtree.model.camera import Camera
from flowtree.model.edit import PaintedEdit
from flowtree.model.field import DirectionField

_STILL = 1e-3  # a sum of directions shorter than this points nowhere
_LEAST_REACH = 0.75  # diagonals of a cell: a stroke finer than the grid still bends the cells it crosses

_Array = NDArray[np.float64]


def bend_direction_field(field: DirectionField, camera: Camera, edit: PaintedEdit) -> DirectionField:
    """Blends the direction of every painted stroke into the cells within its reach.

    With d the distance of a cell's centre to the stroke and r its reach the stroke's tangent, from its first
    point to its last, weighs 1 - 3(d/r)² + 2(d/r)³: all on the stroke, nothing at r, smooth at both. Cells
    farther than r keep their bytes. Later strokes lie over earlier ones.

    Args:
        field: of the view.
        camera: of the view: places the strokes' pixels in its plane.
        edit: its ``directions`` and ``reach`` are used.

    Returns: the bent field; the same one where nothing is painted.

    Raises:
        InputError: a stroke of one point or with NaN, a reach that is not above 0, not one reach a stroke.
    """
    check.require(
        len(edit.reach) == len(edit.directions),
        "painted directions",
        "need one reach for every stroke",
        f"{len(edit.reach)} for {len(edit.directions)}",
        "give each stroke its own",
    )
    if not edit.directions:
        return field
    rows, columns = field.vectors.shape[:2]
    cell = field.cell.astype(np.float64)
    x = field.origin[0] + (np.arange(columns) + 0.5) * cell[0]
    y = field.origin[1] + (np.arange(rows) + 0.5) * cell[1]
    centres = np.stack(np.meshgrid(x, y), axis=2)
    vectors = field.vectors.copy()
    for number, (stroke, reach) in enumerate(zip(edit.directions, edit.reach, strict=True)):
        thing = f"painted direction {number}"
        line = drop_repeats(check.array(stroke, thing, shape=(None, 2), dtype=np.float64))
        check.require(len(line) >= 2, thing, "needs two different points", len(line), "draw it longer")
        wide = bool(np.isfinite(reach)) and reach > 0.0
        check.require(wide, thing, "needs a reach above 0 pixels", reach, "widen it")
        far = max(reach * camera.metres_per_pixel, _LEAST_REACH * float(np.hypot(*cell)))
        _bend(vectors, centres, pixels_to_plane(line, camera), far)
    return replace(field, vectors=vectors)


def _bend(vectors: NDArray[np.float32], centres: _Array, line: _Array, reach: float) -> None:
    """Blends one stroke [m] into the vectors, in place."""
    line = subdivide_polyline(line, reach)
    low, high = line.min(axis=0) - reach, line.max(axis=0) + reach
    near = np.nonzero(((centres > low) & (centres < high)).all(axis=2))
    if len(near[0]) == 0:
        return
    place = centres[near]
    best = np.full(len(place), np.inf)
    tangent = np.zeros_like(place)
    for start, end in pairwise(line):
        _, nearest = nearest_on_segments(place, start, end)
        distance = np.linalg.norm(place - nearest, axis=1)
        closer = distance < best
        best[closer] = distance[closer]
        tangent[closer] = (end - start) / np.linalg.norm(end - start)
    inside = best < reach
    at = (near[0][inside], near[1][inside])
    d = best[inside, None] / reach
    share = 1.0 - d * d * (3.0 - 2.0 * d)
    blend = share * tangent[inside] + (1.0 - share) * vectors[at]
    size = np.linalg.norm(blend, axis=1, keepdims=True)
    # Where stroke and field cancel the stroke wins: it is what a person asked for.
    vectors[at] = np.where(size > _STILL, blend / np.maximum(size, _STILL), tangent[inside])
