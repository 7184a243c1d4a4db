"""The camera of a straightened photograph, and the map that straightens it."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from flowtree.geometry.central_plane import PlaneView
from flowtree.model.camera import Camera
from flowtree.photos.level_picture import roll_matrix

# How much of the plane is kept beside and above the tree, and below its foot [tree heights].
_BESIDE, _ABOVE, _BELOW = 1.2, 1.25, 0.15
_MARGIN = 0.02  # [tree heights] that a picture always shows beyond foot and top
_CROWN = 0.6  # half of a wide crown [tree heights]


def straight_camera(
    plane: PlaneView,
    foot: tuple[float, float],
    roll: float,
    shape: tuple[int, ...],
    *,
    yaw: float,
    height: float,
    missing: tuple[str, ...] = (),
) -> tuple[Camera, NDArray[np.float64] | None]:
    """Sees the plane through the tree's axis straight on, as large as the photograph shows it.

    Args:
        plane: as the level photograph shows it.
        foot: (x, y) [pixels] of the photograph.
        roll: of the photograph [degrees].
        shape: of the photograph: rows and columns.
        yaw: [degrees].
        height: of the tree [m].
        missing: sides at which the tree leaves the photograph: there the picture shows what is beyond, too.

    Returns: the camera, and the (3, 3) map from its pixels to the photograph's, up to scale; None where they
        are the same.
    """
    rows, columns = shape[0], shape[1]
    pixels = plane.foot - plane.top
    if roll == 0.0 and math.isinf(plane.distance) and not missing:
        return Camera(float(yaw), height / pixels, (float(foot[0]), float(foot[1])), columns, rows), None
    to_photo = roll_matrix(foot, roll) @ plane.homography(foot[0])
    border = np.linspace(0.0, 1.0, 33)
    edge = np.concatenate(
        [np.stack([border * columns, np.full(33, side * rows)], axis=1) for side in (0.0, 1.0)]
        + [np.stack([np.full(33, side * columns), border * rows], axis=1) for side in (0.0, 1.0)]
    )
    seen = np.linalg.inv(to_photo) @ np.c_[edge, np.ones(len(edge))].T
    # The photograph may show the plane's vanishing line: beyond it there is no plane.
    ahead = (to_photo @ seen)[2] * seen[2] > 0.0
    x, y = seen[:2] / np.where(seen[2] == 0.0, 1e-9, seen[2])
    x, y = x[ahead], y[ahead]
    left, right = max(float(x.min()), -_BESIDE), min(float(x.max()), _BESIDE)
    low, high = max(float(y.min()), -_BELOW), min(float(y.max()), _ABOVE)
    wide = [_CROWN if side in missing else _MARGIN for side in ("left", "right")]
    left, right = min(left, -wide[0]), max(right, wide[1])
    low, high = min(low, -_MARGIN), max(high, 1.0 + _MARGIN)
    largest = max(right - left, high - low) * pixels
    scale = pixels * min(1.0, max(rows, columns) / largest)  # pixels per tree height
    x0, y0 = -left * scale, high * scale
    to_plane = np.array([[1.0 / scale, 0.0, -x0 / scale], [0.0, -1.0 / scale, y0 / scale], [0.0, 0.0, 1.0]])
    width, tall = math.ceil((right - left) * scale), math.ceil((high - low) * scale)
    away, eye = plane.distance * height, plane.eye * height if math.isfinite(plane.distance) else 0.0
    return Camera(float(yaw), height / scale, (x0, y0), width, tall, away, eye), to_photo @ to_plane
