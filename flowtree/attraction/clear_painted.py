"""Limbs make way where a person painted another direction (Particle Flows, sections 1 and 10)."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from flowtree.geometry.parent_array import levels
from flowtree.geometry.polylines import nearest_on_segments
from flowtree.geometry.projection import pixels_to_plane, to_plane
from flowtree.model.attractor import LimbTree
from flowtree.model.camera import Camera
from flowtree.model.edit import PaintedEdit
from flowtree.model.field import LimbField

_AGREES = 0.5  # cosine between limb and stroke from which the limb may stay

_Array = NDArray[np.float64]


def clear_painted(limbs: LimbTree, cameras: Sequence[Camera], edits: Sequence[PaintedEdit]) -> LimbTree:
    """Drops limbs, with all that grows from them, from where they run across a painted direction.

    Args:
        limbs: the root at the origin.
        cameras: of the views.
        edits: one a view; their ``directions`` and ``reach`` are used.

    Returns: what is left, at least the root and its first segment; the same limbs where nothing is painted.
    """
    parent, points = limbs.parent, limbs.points.astype(np.float64)
    gone = np.zeros(len(parent), np.bool_)
    for camera, edit in zip(cameras, edits, strict=True):
        if not edit.directions:
            continue
        flat = to_plane(points, camera)
        share, tangent = _painted(flat, camera, edit)
        down = flat[np.maximum(parent, 0)] - flat
        down /= np.maximum(np.linalg.norm(down, axis=1, keepdims=True), 1e-12)
        gone |= (share > 0.0) & (np.einsum("ij,ij->i", down, tangent) < _AGREES)
    gone[:2] = False  # a tree has a foot
    for nodes in levels(parent)[1:]:
        gone[nodes] |= gone[parent[nodes]]
    if not gone.any():
        return limbs
    index = np.cumsum(~gone) - 1
    below = parent[~gone]
    left = np.where(below >= 0, index[below], -1).astype(np.int32)
    return LimbTree(left, limbs.points[~gone], limbs.radius[~gone])


def fade_painted(field: LimbField, cameras: Sequence[Camera], edits: Sequence[PaintedEdit]) -> LimbField:
    """Takes the limbs' field back where a direction is painted: there the view's own, bent field leads.

    Args:
        field: around the limbs.
        cameras: of the views.
        edits: one a view.

    Returns: the same field where nothing is painted.
    """
    vectors = field.vectors
    axes = [field.corner[k] + np.arange(vectors.shape[k]) * field.spacing for k in range(3)]
    for camera, edit in zip(cameras, edits, strict=True):
        if edit.directions:
            place = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
            share, _ = _painted(to_plane(place, camera), camera, edit)
            vectors = vectors * (1.0 - share).reshape(*vectors.shape[:3], 1).astype(np.float32)
    return LimbField(vectors, field.corner, field.spacing)


def _painted(flat: _Array, camera: Camera, edit: PaintedEdit) -> tuple[_Array, _Array]:
    """How much painted directions count at places (n, 2) of the view's plane, 0..1, and where they lead."""
    share, tangent = np.zeros(len(flat)), np.zeros((len(flat), 2))
    for stroke, pixels in zip(edit.directions, edit.reach, strict=True):
        line = pixels_to_plane(stroke, camera)
        reach = pixels * camera.metres_per_pixel
        near = np.flatnonzero(
            ((flat > line.min(axis=0) - reach) & (flat < line.max(axis=0) + reach)).all(axis=1)
        )
        best = np.full(len(near), np.inf)
        along = np.zeros((len(near), 2))
        for start, end in pairwise(line):
            length = float(np.linalg.norm(end - start))
            if length == 0.0:
                continue
            _, nearest = nearest_on_segments(flat[near], start, end)
            distance = np.linalg.norm(nearest - flat[near], axis=1)
            closer = distance < best
            best[closer] = distance[closer]
            along[closer] = (end - start) / length
        inside = best < reach
        d = best[inside] / reach
        share[near[inside]] = np.maximum(share[near[inside]], 1.0 - d * d * (3.0 - 2.0 * d))
        tangent[near[inside]] = along[inside]
    return share, tangent
