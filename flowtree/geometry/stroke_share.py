"""How much strokes count at places beside them, and where they lead there."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from flowtree.geometry.polylines import nearest_on_segments

_Array = NDArray[np.float64]


def stroke_share(
    places: _Array, strokes: Sequence[_Array], reaches: Sequence[float]
) -> tuple[_Array, _Array]:
    """The weight 1 - 3(d/r)² + 2(d/r)³ of the strokes, d away and of reach r: 1 on them, 0 beyond.

    Args:
        places: (n, 2).
        strokes: polylines (k, 2).
        reaches: one a stroke.

    Returns: the largest weight of any stroke (n,), 0..1, and the unit tangent (n, 2) of the last stroke that
        reaches there, from its first point to its last; zeros where none does.
    """
    share, tangent = np.zeros(len(places)), np.zeros((len(places), 2))
    for line, reach in zip(strokes, reaches, strict=True):
        near = np.flatnonzero(
            ((places > line.min(axis=0) - reach) & (places < line.max(axis=0) + reach)).all(axis=1)
        )
        best = np.full(len(near), np.inf)
        along = np.zeros((len(near), 2))
        for start, end in pairwise(line):
            length = float(np.linalg.norm(end - start))
            if length == 0.0:
                continue
            _, nearest = nearest_on_segments(places[near], start, end)
            distance = np.linalg.norm(nearest - places[near], axis=1)
            closer = distance < best
            best[closer] = distance[closer]
            along[closer] = (end - start) / length
        inside = best < reach
        d = best[inside] / reach
        share[near[inside]] = np.maximum(share[near[inside]], 1.0 - d * d * (3.0 - 2.0 * d))
        tangent[near[inside]] = along[inside]
    return share, tangent
