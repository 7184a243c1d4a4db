"""The plane through a tree's axis that faces the viewer, as a perspective photograph shows it.

Lengths here are tree heights: the foot is at height 0 of the plane, the top at 1. Rows of the picture grow
downwards; the picture is level (no roll).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True)
class PlaneView:
    """How a level perspective camera sees the plane through the tree's axis that faces it.

    With h a height in the plane and x the way to the right of the axis, a point is seen ``x * scale(h)``
    pixels right of the foot's column at ``row(h)``: one row holds one height, as without perspective.

    Attributes:
        foot: row of height 0 [pixels].
        top: row of height 1 [pixels].
        distance: from the axis [tree heights]; infinite for a parallel projection.
        eye: height of the eye [tree heights].
        pitch: by how much the camera looks up [radians].
        focal: focal length [pixels]; infinite for a parallel projection.
    """

    foot: float
    top: float
    distance: float = math.inf
    eye: float = 0.0
    pitch: float = 0.0
    focal: float = math.inf

    def row(self, height: ArrayLike) -> NDArray[np.float64]:
        """Rows [pixels] at which heights of the plane are seen."""
        tall = np.asarray(height, np.float64)
        if math.isinf(self.distance):
            return self.foot + (self.top - self.foot) * tall
        low = self._sight(np.zeros(1))[0]
        return np.asarray(self.foot - self.focal * (self._sight(tall) - low))

    def scale(self, height: ArrayLike) -> NDArray[np.float64]:
        """Pixels per tree height along image-right, of heights of the plane."""
        tall = np.asarray(height, np.float64)
        if math.isinf(self.distance):
            return np.full(tall.shape, self.foot - self.top)
        return np.asarray(self.focal / self._depth(tall))

    def height(self, row: ArrayLike) -> NDArray[np.float64]:
        """Heights of the plane that rows [pixels] show; NaN above the plane's vanishing line."""
        rows = np.asarray(row, np.float64)
        if math.isinf(self.distance):
            return (self.foot - rows) / (self.foot - self.top)
        sight = self._sight(np.zeros(1))[0] + (self.foot - rows) / self.focal
        sine, cosine = math.sin(self.pitch), math.cos(self.pitch)
        under = cosine - sight * sine
        rise = self.distance * (sight * cosine + sine) / np.where(under > 1e-6, under, np.nan)
        return np.asarray(self.eye + rise)

    def homography(self, column: float) -> NDArray[np.float64]:
        """(3, 3) from (x, height, 1) of the plane to (column, row, 1) [pixels], up to scale.

        Args:
            column: in which the axis is seen [pixels].
        """
        if math.isinf(self.distance):
            pixels = self.foot - self.top
            return np.array([[pixels, 0.0, column], [0.0, -pixels, self.foot], [0.0, 0.0, 1.0]])
        sine, cosine = math.sin(self.pitch), math.cos(self.pitch)
        depth = np.array([0.0, sine, self.distance * cosine - self.eye * sine])
        rise = np.array([0.0, cosine, -self.eye * cosine - self.distance * sine])
        centre = self.foot + self.focal * self._sight(np.zeros(1))[0]
        across = np.array([self.focal, 0.0, 0.0])
        return np.stack([across + column * depth, centre * depth - self.focal * rise, depth])

    def _depth(self, tall: NDArray[np.float64]) -> NDArray[np.float64]:
        """Distance along the camera's axis."""
        return np.asarray(
            self.distance * math.cos(self.pitch) + (tall - self.eye) * math.sin(self.pitch), np.float64
        )

    def _sight(self, tall: NDArray[np.float64]) -> NDArray[np.float64]:
        """Tangent of the angle above the camera's axis."""
        rise = (tall - self.eye) * math.cos(self.pitch) - self.distance * math.sin(self.pitch)
        return np.asarray(rise / self._depth(tall))


def view_from_distance(foot: float, top: float, *, distance: float, eye: float) -> PlaneView:
    """The view of a camera of unknown focal length that stands at a known distance.

    The camera is taken to aim at the middle of the angle between foot and top: of a photograph that was
    shifted, scaled or cropped afterwards nothing else is known, and then none of that changes the view.

    Args:
        foot: its row [pixels].
        top: its row [pixels], above the foot.
        distance: [tree heights]; infinite for a parallel projection.
        eye: its height [tree heights].
    """
    if math.isinf(distance):
        return PlaneView(foot, top)
    down, up = math.atan2(eye, distance), math.atan2(1.0 - eye, distance)
    half = (down + up) / 2
    return PlaneView(foot, top, distance, eye, half - down, (foot - top) / 2 / math.tan(half))


def view_from_focal(foot: float, top: float, *, focal: float, centre: float, eye: float) -> PlaneView:
    """The view of a camera of known focal length: how large the tree looks says how far away it is.

    Foot and top are seen under the angles that rows and focal length give; seen from the eye's height, one
    distance alone has a tree of height 1 under that angle.

    Args:
        foot: its row [pixels].
        top: its row [pixels], above the foot.
        focal: length [pixels].
        centre: row of the photograph's middle [pixels].
        eye: its height [tree heights], 0 to 1.
    """
    below = math.atan2(foot - centre, focal)
    angle = below + math.atan2(centre - top, focal)
    tangent = math.tan(min(angle, math.radians(89.0)))
    product = eye * (1.0 - eye)
    distance = (1.0 + math.sqrt(1.0 + 4.0 * product * tangent**2)) / (2.0 * tangent)
    return PlaneView(foot, top, distance, eye, below - math.atan2(eye, distance), focal)
