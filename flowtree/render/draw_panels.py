"""The single pictures of a contact sheet."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from flowtree.geometry.projection import plane_to_pixels
from flowtree.model.attractor import AttractorGraph
from flowtree.model.camera import Camera
from flowtree.model.matte import Matte
from flowtree.model.photo import Photo

Picture = NDArray[np.uint8]
Alpha = NDArray[np.float32]

_HORIZON = np.array([[196, 214, 230], [236, 238, 234]], float)  # a plain sky, from above to below
_UNKNOWN = np.array([70.0, 120.0, 220.0])
_GRAPH = (190, 20, 60)
_ROOM = 0.06  # of the tree's height, left free around it
_SEEN = 0.1  # alpha from which on a pixel belongs to the tree's box


def crop_view(
    photo: Photo, matte: Matte, camera: Camera, *, width: int, height: int
) -> tuple[Camera, Picture, Alpha, NDArray[np.bool_] | None]:
    """Camera, photo, alpha and unknown pixels of the tree's part of a view, scaled to a panel.

    Args:
        photo: (h, w).
        matte: of the same size.
        camera: of the same view.
        width: of the panel at most [pixels].
        height: of the panel at most [pixels].
    """
    rows, columns = (np.flatnonzero((matte.alpha > _SEEN).any(axis=axis)) for axis in (1, 0))
    full = matte.alpha.shape
    if not len(rows):
        rows, columns = np.array([0, full[0] - 1]), np.array([0, full[1] - 1])
    room = _ROOM * (rows[-1] - rows[0] + 1)
    top, left = max(0, int(rows[0] - room)), max(0, int(columns[0] - room))
    bottom = min(full[0], int(rows[-1] + room) + 1)
    right = min(full[1], int(columns[-1] + room) + 1)
    shrink = max((right - left) / width, (bottom - top) / height)
    size = max(1, round((right - left) / shrink)), max(1, round((bottom - top) / shrink))

    def fit(picture: NDArray[Any]) -> NDArray[Any]:
        part = picture[top:bottom, left:right]
        return np.asarray(cv2.resize(part, size, interpolation=cv2.INTER_AREA))

    near = replace(
        camera,
        metres_per_pixel=camera.metres_per_pixel * shrink,
        foot=((camera.foot[0] - left) / shrink, (camera.foot[1] - top) / shrink),
        width=size[0],
        height=size[1],
    )
    alpha = np.asarray(np.clip(fit(matte.alpha), 0, 1), np.float32)
    unknown = None if matte.unknown is None else fit(matte.unknown.astype(np.float32)) > 0.5
    return near, np.asarray(fit(photo.rgb), np.uint8), alpha, unknown


def draw_matte(alpha: Alpha, unknown: NDArray[np.bool_] | None) -> Picture:
    """Alpha (h, w) in grey; blue where it is unknown."""
    grey = np.repeat(np.rint(255 * alpha).astype(np.uint8)[:, :, None], 3, axis=2)
    return grey if unknown is None else _tint(grey, unknown)


def draw_graph(rgb: Picture, graph: AttractorGraph | None, camera: Camera) -> Picture:
    """The photo, paled, under the graph: thick at the foot, thin at the tips."""
    canvas = np.ascontiguousarray((0.55 * rgb + 0.45 * 255).astype(np.uint8))
    if graph is None:
        return canvas
    at = np.rint(16 * (plane_to_pixels(graph.points, camera) - 0.5)).astype(int)
    tips = np.ones(len(at))
    for node in range(len(at) - 1, 0, -1):
        tips[graph.parent[node]] += tips[node]
    for node in range(1, len(at)):
        wide = 1 + round(2 * (tips[node] / tips[0]) ** 0.5)
        start, end = (tuple(int(n) for n in at[k]) for k in (graph.parent[node], node))
        cv2.line(canvas, start, end, _GRAPH, wide, cv2.LINE_AA, shift=4)
    return canvas


def lay_over_sky(rgba: Picture) -> Picture:
    """A rendered tree (h, w, 4) before a plain sky."""
    height, width = rgba.shape[:2]
    share = np.linspace(0, 1, height)[:, None, None]
    sky = np.broadcast_to((1 - share) * _HORIZON[0] + share * _HORIZON[1], (height, width, 3))
    alpha = rgba[:, :, 3:] / 255.0
    return np.asarray(np.rint(rgba[:, :, :3] * alpha + sky * (1 - alpha)), np.uint8)


def draw_difference(alpha: Alpha, drawn: Picture, unknown: NDArray[np.bool_] | None) -> Picture:
    """Grey where both agree on tree, orange where only the photo has it, blue where only the model has it.

    Args:
        alpha: (h, w) of the photo, in 0..1.
        drawn: (h, w) of the model, in 0..255.
        unknown: (h, w) where there is nothing to compare, left pale.
    """
    model = drawn.astype(np.float32) / np.float32(255)
    both = np.minimum(alpha, model)[:, :, None]
    missing, surplus = np.maximum(alpha - model, 0)[:, :, None], np.maximum(model - alpha, 0)[:, :, None]
    color = 255.0 - both * 130.0 - missing * np.array([15, 120, 225]) - surplus * np.array([215, 130, 20])
    picture = np.asarray(np.rint(np.clip(color, 0, 255)), np.uint8)
    return picture if unknown is None else _tint(picture, unknown)


def _tint(picture: Picture, unknown: NDArray[np.bool_]) -> Picture:
    mixed = np.where(unknown[:, :, None], 0.4 * picture + 0.6 * _UNKNOWN, picture)
    return np.asarray(np.rint(mixed), np.uint8)
