"""Drawn strokes become one rooted tree in the plane."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from flowtree.geometry.polylines import arc_lengths, drop_repeats, subdivide_polyline
from flowtree.model.attractor import AttractorGraph

_FINE = 96  # nodes along a stroke as long as the drawing
_MOST_STROKES = 400

_Array = NDArray[np.float64]


def join_strokes(strokes: Sequence[NDArray[np.floating]]) -> AttractorGraph:
    """Joins strokes at the places where they come nearest to each other, from the lowest end up.

    The lowest end of a stroke is where the twig grows from its branch. The stroke that comes nearest to what
    is joined already is joined next, where it comes nearest, with one end or in its middle.

    Args:
        strokes: polylines (k, 2) as (x, y), y downwards, any unit; at most 400 of them count.

    Returns: the tree in the drawing's unit, y upwards, its root, the lowest end, at (0, 0).
    """
    lines = [drop_repeats(np.asarray(line, np.float64) * (1.0, -1.0)) for line in strokes[:_MOST_STROKES]]
    lines = [line for line in lines if len(line) > 1]
    extent = float(np.ptp(np.concatenate(lines), axis=0).max())
    lines = [subdivide_polyline(line, max(extent / _FINE, 1e-9)) for line in lines]
    ends = [min(line[0, 1], line[-1, 1]) for line in lines]
    first = lines.pop(int(np.argmin(ends)))
    first = first if first[0, 1] <= first[-1, 1] else first[::-1]
    points, parent = [first], [np.arange(-1, len(first) - 1)]
    known = first
    near = [_nearest(line, first, 0) for line in lines]
    while lines:
        chosen = min(range(len(lines)), key=lambda k: near[k][0])
        line, (_, own, at) = lines.pop(chosen), near.pop(chosen)
        before = len(known)
        forth, back = line[own:], line[:own][::-1]
        added = np.concatenate([forth, back])
        above = np.arange(before - 1, before + len(added) - 1)
        above[0] = at
        if len(back):
            above[len(forth)] = before  # the other half starts from the same place
        points.append(added)
        parent.append(above)
        known = np.concatenate([known, added])
        near = [min(old, _nearest(rest, added, before)) for rest, old in zip(lines, near, strict=True)]
    array = np.concatenate(parent).astype(np.int32)
    return AttractorGraph(parent=array, points=(known - known[0]).astype(np.float32))


def _nearest(line: _Array, known: _Array, first: int) -> tuple[float, int, int]:
    """How near a stroke comes to known points, with which of its own, and to which (counted from first)."""
    gap = np.linalg.norm(line[:, None] - known[None], axis=2)
    # An end is as good as what comes a little nearer: strokes are drawn across each other.
    inner = np.full(len(line), 0.05 * float(arc_lengths(line)[-1]))
    inner[[0, -1]] = 0.0
    own, at = np.unravel_index(int(np.argmin(gap + inner[:, None])), gap.shape)
    return float(gap[own, at]), int(own), first + int(at)
