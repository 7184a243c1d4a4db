"""Checks the places that a person pointed at in a photo."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flowtree import check
from flowtree.model.marks import ViewMarks
from flowtree.model.photo import Photo

_SLACK = 0.5  # working pixels outside the picture: as much as rounding its size to whole pixels may cost


def check_marks(marks: ViewMarks, photo: Photo, *, name: str, scale: float = 1.0) -> ViewMarks:
    """The marks in working pixels, once they are known to lie in the picture, one above the other.

    Args:
        marks: of the photo, in pixels of which ``scale`` make a working pixel.
        photo: the photo they belong to.
        name: whose marks they are, for the error.
        scale: working pixels per pixel of the marks.

    Returns: marks of plain numbers, none of them outside the picture.

    Raises:
        InputError: no marks, not numbers, NaN, a place outside the picture, a foot not below the fork, or
            either of them not below the top.
    """
    kind = type(marks).__name__
    check.require(isinstance(marks, ViewMarks), name, "must be ViewMarks", kind, "pass flowtree.ViewMarks")
    high, wide = photo.rgb.shape[:2]
    size = np.array([wide, high], np.float64)

    def inside(value: Any, thing: str, limit: NDArray[np.float64]) -> NDArray[np.float64]:
        flat = check.array(value, f"{name}, {thing}", shape=(None, len(limit)), dtype=np.float64)
        slack = _SLACK / scale
        out = ((flat < -slack) | (flat > limit / scale + slack)).any(axis=1)
        across = " x ".join(f"{length:.0f}" for length in size / scale)
        check.require(
            not out.any(),
            f"{name}, {thing}",
            f"must lie in the photo ({across})",
            flat[out][:1].squeeze().tolist(),
            "count pixels from the photo's upper left corner",
        )
        return np.clip(flat * scale, 0.0, limit)

    foot = None if marks.foot is None else inside([marks.foot], "foot", size)[0].tolist()
    top = None if marks.top is None else float(inside([[marks.top]], "top", size[1:])[0, 0])
    fork = None if marks.fork is None else inside([marks.fork], "fork", size)[0].tolist()
    seeds = inside(marks.seeds, "seeds", size)
    rows = {"top": top, "fork": None if fork is None else fork[1], "foot": None if foot is None else foot[1]}
    given = [(thing, row) for thing, row in rows.items() if row is not None]
    for (upper, above), (lower, below) in pairwise(given):
        check.require(
            above < below,
            f"{name}, {lower}",
            f"must lie below the {upper}",
            f"rows {below / scale:g} and {above / scale:g}",
            "swap them, or leave one out",
        )
    return ViewMarks(
        foot=None if foot is None else (foot[0], foot[1]),
        top=top,
        fork=None if fork is None else (fork[0], fork[1]),
        seeds=seeds.astype(np.float32),
    )
