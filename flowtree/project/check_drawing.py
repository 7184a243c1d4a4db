"""Checks what is drawn on a photo before it becomes a part of the document."""

from __future__ import annotations

import math

import numpy as np

from flowtree import check
from flowtree.model.marks import ViewMarks
from flowtree.model.photo import Photo
from flowtree.photos.check_marks import check_marks
from flowtree.project.document_state import DrawnPhoto
from flowtree.project.drawings import Marks, Points

_MOST_POINTS = 20_000  # of a stroke
_FARTHEST = 1e6  # pixels
_EDGE = 1e-3  # of the photo's larger side: what is drawn only there may fall outside the working picture


def check_points(points: Points, photo: DrawnPhoto, thing: str, *, least: int = 1) -> None:
    """Refuses a stroke of too few or too many points, or one without a point in the photo.

    Raises:
        InputError: it is so, or a coordinate is no finite number.
    """
    count = len(points)
    check.require(
        count <= _MOST_POINTS, thing, f"must have at most {_MOST_POINTS} points", count, "draw less"
    )
    known = all(math.isfinite(v) and abs(v) <= _FARTHEST for point in points for v in point)
    check.require(known, thing, "must be places near the photo", "others", "draw on the photo")
    different = len(set(points))
    check.require(different >= least, thing, f"needs {least} different points", different, "draw it longer")
    edge = _EDGE * max(photo.width, photo.height)
    inside = any(edge <= x <= photo.width - edge and edge <= y <= photo.height - edge for x, y in points)
    size = f"{photo.width} x {photo.height}"
    check.require(inside, thing, f"needs a point in the photo ({size})", "none", "draw on the photo")


def check_width(width: float, photo: DrawnPhoto, thing: str) -> None:
    """Refuses a brush without width, or one wider than all of the photo.

    Raises:
        InputError: it is so.
    """
    widest = photo.width + photo.height
    fits = math.isfinite(width) and 0.0 < width <= widest
    check.require(fits, thing, f"needs a width from 0 to {widest} pixels", width, "choose another brush")


def check_share(value: float, thing: str, *, low: float = 0.0) -> None:
    """Refuses a number that is no share.

    Raises:
        InputError: it is not more than ``low``, or more than 1.
    """
    fits = math.isfinite(value) and low <= value <= 1.0
    check.require(fits, thing, f"must be {low:g} to 1", value, "give a share")


def check_photo_marks(marks: Marks, photo: DrawnPhoto) -> None:
    """Refuses marks that lie outside of the photo or stand on their heads.

    Raises:
        InputError: it is so.
    """
    blank = Photo(photo.name, np.broadcast_to(np.uint8(0), (photo.height, photo.width, 3)))
    given = ViewMarks(
        foot=marks.foot,
        top=marks.top,
        fork=marks.fork,
        seeds=np.array(marks.seeds, np.float64).reshape(-1, 2).astype(np.float32),
        roll=marks.roll,
        distance=marks.distance,
        focal_length=marks.focal_length,
    )
    check_marks(given, blank, name=photo.name)
