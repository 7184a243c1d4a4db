"""Projection between the world, a view's plane and its pixels: parallel, or from an eye near the tree.

Every picture shows the plane through the tree's axis that faces the viewer. A parallel projection moves a
point straight onto it; an eye at the distance D and the height e sees what is d nearer than the axis
D / (D - d) times as far from its own height and from the axis: `foreshorten` moves it there, and then all is
parallel.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

#: Of the eye's distance: what is nearer to the eye is taken to be as far as that.
NEAREST = 0.1


class Sight(Protocol):
    """From where a plane is looked at."""

    @property
    def yaw(self) -> float:
        """[degrees]."""

    @property
    def distance(self) -> float:
        """Of the eye from the tree's axis [m]; infinite for a parallel projection."""

    @property
    def eye(self) -> float:
        """Height of the eye above the foot [m]; without meaning for a parallel projection."""


@dataclass(frozen=True)
class Viewpoint:
    """A sight without a picture; unless told otherwise a parallel projection.

    Attributes:
        yaw: [degrees].
        distance: of the eye from the tree's axis [m]; infinite for a parallel projection.
        eye: its height [m].
    """

    yaw: float
    distance: float = math.inf
    eye: float = 0.0


class View(Sight, Protocol):
    """What the projection needs to know of a camera."""

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


def growth(points: ArrayLike, sight: Sight) -> NDArray[np.float64]:
    """How many times as large as on the plane through the axis things at world points (n, 3) [m] are seen."""
    place = np.asarray(points, np.float64)
    if math.isinf(sight.distance):
        return np.ones(len(place))
    nearer = place @ view_axes(sight.yaw)[2] / sight.distance
    return np.asarray(1.0 / np.maximum(1.0 - nearer, NEAREST))


def foreshorten(points: ArrayLike, sight: Sight) -> NDArray[np.float64]:
    """World points (n, 3) [m] where a parallel projection at the same yaw sees them as the eye does.

    They are moved along their lines of sight onto the plane through the axis, and as far before or behind it
    as keeps straight lines straight and what is nearer nearer: a projective map of space.
    """
    place = np.asarray(points, np.float64)
    if math.isinf(sight.distance):
        return place
    eye = np.array([0.0, sight.eye, 0.0])
    return np.asarray(eye + (place - eye) * growth(place, sight)[:, None])


def from_plane(plane: ArrayLike, depth: ArrayLike, sight: Sight) -> NDArray[np.float64]:
    """World points (…, 3) [m], so much nearer to the viewer than the axis, that are seen in these places.

    Args:
        plane: (…, 2) [m], image-right and up in the plane of the view.
        depth: (…) [m] toward the viewer.
        sight: of the view.
    """
    right, up, toward = view_axes(sight.yaw)
    flat, near = np.asarray(plane, np.float64), np.asarray(depth, np.float64)[..., None]
    shrink = 1.0 - near / sight.distance
    rise = (
        sight.eye + (flat[..., 1:] - sight.eye) * shrink if math.isfinite(sight.distance) else flat[..., 1:]
    )
    return np.asarray(flat[..., :1] * shrink * right + rise * up + near * toward)


def lines_of_sight(points: ArrayLike, sight: Sight) -> NDArray[np.float64]:
    """How world points (n, 3) [m] move along their lines of sight while they come nearer by 1: (n, 3)."""
    place = np.asarray(points, np.float64)
    toward = view_axes(sight.yaw)[2]
    if math.isinf(sight.distance):
        return np.tile(toward, (len(place), 1))
    eye = sight.distance * toward + np.array([0.0, sight.eye, 0.0])
    return np.asarray((eye - place) * (growth(place, sight) / sight.distance)[:, None])


def to_plane(points: ArrayLike, sight: Sight) -> NDArray[np.float64]:
    """World points (n, 3) [m] in the plane of a view: (n, 2) [m], image-right and up."""
    right, up, _ = view_axes(sight.yaw)
    return foreshorten(points, sight) @ np.stack([right, up], axis=1)


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
    return plane_to_pixels(to_plane(points, view), view)
