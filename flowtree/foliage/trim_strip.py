"""The least strip around a leaf's outline."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

_LEAST = 0.005  # half width of a corner [m]: a strip must not close
_PLACES = np.linspace(0.2, 0.8, 7)  # along the leaf, at which the corner between two bands is tried
_MOST_CUTS = 100  # each ends on a row of the texture that it has not ended on before


def trim_strip(bands: int, width: float, there: NDArray[np.bool_]) -> tuple[Floats, Floats]:
    """Where a strip of ``bands`` trapezoids has its corners, so that it holds every texel and little else.

    The least area is a linear programme for given places. With two bands the place between them is searched
    too, and the programme, whose outer corners follow from the middle one, is solved along that one alone.

    Args:
        bands: at least 2.
        width: of the texture [m].
        there: (h, w), texels that may be seen; the leaf's stalk is at the bottom.

    Returns: (bands + 1,) places along the leaf, 0..1, and half widths there [m].
    """
    rows, columns = there.shape
    away = (np.abs(np.arange(columns) + 0.5 - columns / 2) + 0.5) * (width / columns)
    reach = np.where(there.any(axis=1), np.max(np.where(there, away, 0.0), axis=1), 0.0)
    height = 1.0 - (np.arange(rows) + 0.5) / rows
    most = 0.5 * width
    if bands != 2:
        along = np.linspace(0.0, 1.0, bands + 1)
        return along, _solve(along, height, reach, most)
    tried = [(np.array([0.0, place, 1.0]), _trim_two(float(place), height, reach, most)) for place in _PLACES]
    return min(tried, key=lambda one: float(_areas(one[0]) @ one[1]))


def _areas(along: Floats) -> Floats:
    """What a metre of half width adds to half the strip's area at each of the places."""
    return 0.5 * np.convolve(np.diff(along), [1.0, 1.0])


def _solve(along: Floats, height: Floats, reach: Floats, most: float) -> Floats:
    from scipy.optimize import linprog  # takes a while to load, and only the arch of a frond needs it

    shares = np.array([np.interp(height, along, corner) for corner in np.eye(len(along))])
    found = linprog(_areas(along), A_ub=-shares.T, b_ub=-reach, bounds=(_LEAST, most), method="highs")
    return np.asarray(found.x, np.float64)


def _trim_two(place: float, height: Floats, reach: Floats, most: float) -> Floats:
    """Half widths (3,) of the least two bands that meet at ``place``.

    The wider the middle, the narrower may the outer corners be: each must reach what a row holds beyond the
    middle's share of it, so it is the largest of lines that fall with the middle's width. The area is thus a
    sum of maxima, convex and piecewise linear: the lines that it follows at two widths meet in a third one,
    until that lies on the area itself.
    """
    slopes, offsets, low = [], [], _LEAST
    for rows, share in (
        (height <= place, height / place),
        (height > place, (1.0 - height) / (1.0 - place)),
    ):
        part, held = share[rows], reach[rows]
        low = max(low, float(np.max((held - (1.0 - part) * most) / part, initial=0.0)))
        outer = part < 1.0
        slopes.append(np.append(-part[outer] / (1.0 - part[outer]), 0.0))
        offsets.append(np.append(held[outer] / (1.0 - part[outer]), _LEAST))
    first, middle, last = _areas(np.array([0.0, place, 1.0]))

    def corners(half: float) -> Floats:
        below, above = (float(np.max(s * half + o)) for s, o in zip(slopes, offsets, strict=True))
        return np.array([below, half, above])

    def line(half: float) -> tuple[float, float]:
        """Slope and offset of the line on which the area lies at this width."""
        lower, upper = (int(np.argmax(s * half + o)) for s, o in zip(slopes, offsets, strict=True))
        slope = first * slopes[0][lower] + middle + last * slopes[1][upper]
        return float(slope), float(first * offsets[0][lower] + last * offsets[1][upper])

    left, right = line(low), line(most)
    if left[0] >= 0.0 or low >= most:
        return corners(low)
    if right[0] <= 0.0:
        return corners(most)
    half = most
    for _ in range(_MOST_CUTS):
        half = (right[1] - left[1]) / (left[0] - right[0])
        found = line(half)
        if found in (left, right) or found[0] == 0.0:
            break
        if found[0] < 0.0:
            left = found
        else:
            right = found
    return corners(half)
