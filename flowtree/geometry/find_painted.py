"""Which places in space somebody has painted, in whichever view."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from flowtree.geometry.projection import View, pixels_to_plane, project, to_plane
from flowtree.geometry.stroke_share import stroke_share

_PAINTED = 0.05  # strength of paint, or weight of a direction, from which on it counts


class Paint(Protocol):
    """What somebody has painted over a view's picture."""

    @property
    def add(self) -> NDArray[np.float32] | None:
        """(h, w) in 0..1."""

    @property
    def erase(self) -> NDArray[np.float32] | None:
        """(h, w) in 0..1."""

    @property
    def directions(self) -> tuple[NDArray[np.float32], ...]:
        """Polylines (k, 2) [pixels]."""

    @property
    def reach(self) -> tuple[float, ...]:
        """Of each of these [pixels]."""


class PaintedPlaces(NamedTuple):
    """What was painted where, (n,) bool each.

    Attributes:
        taken: where something was erased or another direction given: what is there has to go.
        added: where something was painted in besides.
    """

    taken: NDArray[np.bool_]
    added: NDArray[np.bool_]

    @property
    def anyhow(self) -> NDArray[np.bool_]:
        """Where anything was painted."""
        return self.taken | self.added


def find_painted(
    points: NDArray[np.floating], cameras: Sequence[View], edits: Sequence[Paint]
) -> PaintedPlaces:
    """Looks the places up in every view's paint: what is behind paint is painted, however far.

    Args:
        points: (n, 3) [m].
        cameras: of the views.
        edits: one a view.
    """
    places = PaintedPlaces(np.zeros(len(points), np.bool_), np.zeros(len(points), np.bool_))
    for camera, edit in zip(cameras, edits, strict=True):
        pixel = np.floor(project(points, camera)).astype(np.int64)
        for found, paint in zip(places, (edit.erase, edit.add), strict=True):
            if paint is not None:
                inside = ((pixel >= 0) & (pixel < (paint.shape[1], paint.shape[0]))).all(axis=1)
                found[inside] |= paint[pixel[inside, 1], pixel[inside, 0]] > _PAINTED
    places.taken[:] |= find_directed(points, cameras, edits)
    return places


def find_directed(
    points: NDArray[np.floating], cameras: Sequence[View], edits: Sequence[Paint]
) -> NDArray[np.bool_]:
    """The places (n,) of the points (n, 3) [m] at which a direction was given, in whichever view."""
    directed = np.zeros(len(points), np.bool_)
    for camera, edit in zip(cameras, edits, strict=True):
        if edit.directions:
            lines = [pixels_to_plane(line, camera) for line in edit.directions]
            reaches = [reach * camera.metres_per_pixel for reach in edit.reach]
            directed |= stroke_share(to_plane(points, camera), lines, reaches)[0] > _PAINTED
    return directed
