"""Checks the places that a person pointed at in a photo."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flowtree import check
from flowtree.model.marks import ViewMarks
from flowtree.model.photo import Photo

#: How far a hidden foot or top may lie outside the picture, in its heights.
_HIDDEN = 1.0
#: Least and largest roll [degrees], distance [m] and focal length [mm].
_RANGES = {"roll": (-45.0, 45.0), "distance": (0.05, 10_000.0), "focal_length": (5.0, 5000.0)}
_SLACK = 0.5  # working pixels outside the picture: as much as rounding its size to whole pixels may cost


def check_marks(marks: ViewMarks, photo: Photo, *, name: str, scale: float = 1.0) -> ViewMarks:
    """The marks in working pixels, once they are known to lie in the picture, one above the other.

    Args:
        marks: of the photo, in pixels of which ``scale`` make a working pixel.
        photo: the photo they belong to.
        name: whose marks they are, for the error.
        scale: working pixels per pixel of the marks.

    Returns: marks of plain numbers, none of them outside the picture; only a foot below it and a top above it
        may be up to its height away.

    Raises:
        InputError: no marks, not numbers, NaN, a place outside the picture, a foot not below the fork, or
            either of them not below the top, a roll, distance or focal length out of range.
    """
    kind = type(marks).__name__
    check.require(isinstance(marks, ViewMarks), name, "must be ViewMarks", kind, "pass flowtree.ViewMarks")
    high, wide = photo.rgb.shape[:2]
    size = np.array([wide, high], np.float64)

    def inside(
        value: Any, thing: str, limit: NDArray[np.float64], above: float = 0.0, below: float = 0.0
    ) -> NDArray[np.float64]:
        flat = check.array(value, f"{name}, {thing}", shape=(None, len(limit)), dtype=np.float64)
        slack = _SLACK / scale
        rows = np.arange(len(limit)) == len(limit) - 1
        least, most = -above * high * rows, limit + below * high * rows
        out = ((flat < least / scale - slack) | (flat > most / scale + slack)).any(axis=1)
        across = " x ".join(f"{length:.0f}" for length in size / scale)
        check.require(
            not out.any(),
            f"{name}, {thing}",
            f"must lie in the photo ({across})",
            flat[out][:1].squeeze().tolist(),
            "count pixels from the photo's upper left corner",
        )
        # Rounding the picture's size does not put its own edge outside.
        edge = np.clip(flat * scale, 0.0, limit)
        return np.where(np.abs(flat * scale - edge) <= _SLACK, edge, np.clip(flat * scale, least, most))

    foot = None if marks.foot is None else inside([marks.foot], "foot", size, below=_HIDDEN)[0].tolist()
    top = None if marks.top is None else float(inside([[marks.top]], "top", size[1:], above=_HIDDEN)[0, 0])
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
        **{thing: _ranged(getattr(marks, thing), f"{name}, {thing}", *_RANGES[thing]) for thing in _RANGES},
    )


def _ranged(value: Any, thing: str, low: float, high: float) -> float | None:
    """A number in its range, or None."""
    if value is None:
        return None
    return float(check.array([value], thing, shape=(1,), low=low, high=high, dtype=np.float64)[0])
