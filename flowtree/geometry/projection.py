"""Orthographic projection between the world, a view's plane and its pixels."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray


class View(Protocol):
    """What the projection needs to know of a camera."""

    @property
    def yaw(self) -> float:
        """[degrees]."""

    @property
    def metres_per_pixel(self) -> float:
        """[m]."""

    @property
    def foot(self) -> tuple[float, float]:
        """(x, y) [pixels] of the world's origin."""


def view_axes(yaw: float) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Unit vectors image-right, up and toward the camera, in the world, of a camera at ``yaw`` [degrees].

    The right angles are exact, so that a view from 90 degrees sees exact coordinates.
    """
    turn = yaw % 360.0 % 360.0  # a tiny negative angle gives 360 itself at first
    if turn % 90.0 == 0.0:
        sine, cosine = ((0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0))[int(turn // 90.0)]
    else:
        sine, cosine = float(np.sin(np.radians(turn))), float(np.cos(np.radians(turn)))
    return np.array([cosine, 0.0, -sine]), np.array([0.0, 1.0, 0.0]), np.array([sine, 0.0, cosine])


def to_plane(points: ArrayLike, yaw: float) -> NDArray[np.float64]:
    """World points (n, 3) [m] in the plane of a view: (n, 2) [m], image-right and up."""
    right, up, _ = view_axes(yaw)
    return np.asarray(points, np.float64) @ np.stack([right, up], axis=1)


def plane_to_pixels(plane: ArrayLike, view: View) -> NDArray[np.float64]:
    """Points of the view's plane (n, 2) [m] as (x, y) [pixels], pixel centres at +0.5."""
    flat = np.asarray(plane, np.float64)
    return np.stack(
        [
            view.foot[0] + flat[:, 0] / view.metres_per_pixel,
            view.foot[1] - flat[:, 1] / view.metres_per_pixel,
        ],
        axis=1,
    )


def pixels_to_plane(pixels: ArrayLike, view: View) -> NDArray[np.float64]:
    """Pixels (n, 2) as (x, y) as points of the view's plane (n, 2) [m]."""
    flat = np.asarray(pixels, np.float64)
    return np.stack(
        [
            (flat[:, 0] - view.foot[0]) * view.metres_per_pixel,
            (view.foot[1] - flat[:, 1]) * view.metres_per_pixel,
        ],
        axis=1,
    )


def project(points: ArrayLike, view: View) -> NDArray[np.float64]:
    """World points (n, 3) [m] as (x, y) [pixels] of the view."""
    return plane_to_pixels(to_plane(points, view.yaw), view)
