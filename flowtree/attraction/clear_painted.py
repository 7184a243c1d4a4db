"""Limbs make way where a person painted another direction (Particle Flows, sections 1 and 10)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from flowtree.geometry.parent_array import levels
from flowtree.geometry.projection import pixels_to_plane, to_plane, view_axes
from flowtree.geometry.stroke_share import stroke_share
from flowtree.model.attractor import LimbTree
from flowtree.model.camera import Camera
from flowtree.model.edit import PaintedEdit
from flowtree.model.field import LimbField

_DEPTH = 0.5  # of the limbs' way in depth, what a painted direction keeps
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


def lead_painted(field: LimbField, cameras: Sequence[Camera], edits: Sequence[PaintedEdit]) -> LimbField:
    """Turns the limbs' field to where a direction is painted, as that view sees it.

    In the view's own field alone the direction would be lost: the other views' know nothing of it, and what
    two views see of a particle's way is averaged. In depth, which the view does not see, the limbs lead on.

    Args:
        field: around the limbs.
        cameras: of the views.
        edits: one a view.

    Returns: the same field where nothing is painted; vectors of length 1 where a direction counts in full.
    """
    if not any(edit.directions for edit in edits):
        return field
    vectors = field.vectors.astype(np.float64)
    axes = [field.corner[k] + np.arange(vectors.shape[k]) * field.spacing for k in range(3)]
    for camera, edit in zip(cameras, edits, strict=True):
        place = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
        share, tangent = _painted(to_plane(place, camera), camera, edit)
        right, up, toward = view_axes(camera.yaw)
        old = vectors.reshape(-1, 3)
        wanted = tangent @ np.stack([right, up]) + _DEPTH * (old @ toward)[:, None] * toward
        wanted /= np.maximum(np.linalg.norm(wanted, axis=1, keepdims=True), 1e-12)
        vectors = (old + share[:, None] * (wanted - old)).reshape(vectors.shape)
    return LimbField(vectors.astype(np.float32), field.corner, field.spacing)


def _painted(flat: _Array, camera: Camera, edit: PaintedEdit) -> tuple[_Array, _Array]:
    """How much painted directions count at places (n, 2) of the view's plane, 0..1, and where they lead."""
    lines = [pixels_to_plane(line, camera) for line in edit.directions]
    return stroke_share(flat, lines, [reach * camera.metres_per_pixel for reach in edit.reach])
