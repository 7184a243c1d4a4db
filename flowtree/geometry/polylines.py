"""Polylines: resampling, smoothing, nearest points."""

from __future__ import annotations

import itertools

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.ndimage import gaussian_filter1d

_Array = NDArray[np.float64]


def arc_lengths(points: ArrayLike) -> _Array:
    """Length (n,) of a polyline (n, d) from its first point to each of its points; the first is 0."""
    line = np.asarray(points, np.float64)
    return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])


def drop_repeats(points: ArrayLike, tolerance: float = 0.0) -> _Array:
    """The polyline (n, d) without points that lie within ``tolerance`` of the one before them."""
    line = np.asarray(points, np.float64)
    if len(line) < 2:
        return line
    keep = np.concatenate([[True], np.linalg.norm(np.diff(line, axis=0), axis=1) > tolerance])
    return np.asarray(line[keep])


def resample_polyline(points: ArrayLike, spacing: float) -> _Array:
    """Points at equal arc lengths of at most ``spacing`` along a polyline (n, d); both ends stay.

    A line without length becomes its two (equal) ends.
    """
    line = np.asarray(points, np.float64)
    along = arc_lengths(line)
    count = max(1, int(np.ceil(along[-1] / spacing - 1e-9)))
    at = np.linspace(0.0, along[-1], count + 1)
    return np.stack([np.interp(at, along, line[:, axis]) for axis in range(line.shape[1])], axis=1)


def subdivide_polyline(points: ArrayLike, spacing: float) -> _Array:
    """The polyline (n, d) with points added so that no segment is longer than ``spacing``; none is moved."""
    line = np.asarray(points, np.float64)
    pieces = [line[:1]]
    for start, end in itertools.pairwise(line):
        count = max(1, int(np.ceil(float(np.linalg.norm(end - start)) / spacing - 1e-9)))
        steps = np.arange(1, count + 1)[:, None] / count
        piece = start + steps * (end - start)
        piece[-1] = end  # exactly, not up to rounding
        pieces.append(piece)
    return np.concatenate(pieces)


def smooth_polyline(points: ArrayLike, sigma: float) -> _Array:
    """Gaussian smoothing of an evenly sampled polyline (n, d); ``sigma`` in samples; the ends stay put.

    The line is continued beyond each end by its point reflection: that keeps the ends and straight lines
    exact.
    """
    line = np.asarray(points, np.float64)
    if len(line) < 3 or sigma < 0.1:  # less than a tenth of a sample changes nothing
        return line.copy()
    reach = min(len(line) - 1, int(np.ceil(4.0 * sigma)))
    before = 2.0 * line[0] - line[reach:0:-1]
    after = 2.0 * line[-1] - line[-2 : -reach - 2 : -1]
    padded = np.concatenate([before, line, after])
    smooth = gaussian_filter1d(padded, sigma, axis=0, mode="nearest", radius=reach)[reach : reach + len(line)]
    smooth[0], smooth[-1] = line[0], line[-1]
    return np.asarray(smooth, np.float64)


def nearest_on_segments(queries: ArrayLike, starts: ArrayLike, ends: ArrayLike) -> tuple[_Array, _Array]:
    """The point of each segment nearest to its query, row by row.

    Args:
        queries: (..., d).
        starts: (..., d) of the segments.
        ends: (..., d); a segment without length is its start.

    Returns:
        fraction: (...) in 0..1, from start to end.
        nearest: (..., d).
    """
    start, end, query = (np.asarray(a, np.float64) for a in (starts, ends, queries))
    along = end - start
    square = np.einsum("...d,...d->...", along, along)
    dot = np.einsum("...d,...d->...", query - start, along)
    fraction = np.clip(np.divide(dot, square, out=np.zeros_like(dot), where=square > 0.0), 0.0, 1.0)
    return fraction, start + fraction[..., None] * along
