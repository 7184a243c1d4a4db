"""Parallel planes, one behind the other, near which most of a thing lies."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
_ROUNDS = 100
_STILL = 1e-4  # of the whole depth


def space_planes(along: Floats, weight: Floats, count: int, held: float) -> tuple[Floats, NDArray[np.intp]]:
    """Places planes so that the sum of pieces' squared distances to the nearest becomes least (Lloyd 1982).

    Of the planes, the one nearest to a given place is held there, such as the trunk's: a trunk cut in two
    between planes would be seen double.

    Args:
        along: (n,) where each piece lies along the planes' normal [m].
        weight: (n,) what it counts, not all 0.
        count: planes, at least 1.
        held: where one of them is to be [m].

    Returns: the planes' places (count,) [m], ascending, and (n,) the nearest of each piece.
    """
    order = np.argsort(along, kind="stable")
    total = np.cumsum(weight[order])
    places = along[order][np.searchsorted(total, (np.arange(count) + 0.5) / count * total[-1])]
    still = _STILL * float(np.ptp(along))
    for _ in range(_ROUNDS):
        before = _hold(places, held)
        index = np.searchsorted(0.5 * (before[1:] + before[:-1]), along)
        filled = np.bincount(index, weight, count)
        mean = np.bincount(index, weight * along, count) / np.maximum(filled, 1e-30)
        places = _hold(np.where(filled > 0, mean, before), held)
        if np.abs(places - before).max() <= still:
            break
    return places, np.searchsorted(0.5 * (places[1:] + places[:-1]), along)


def _hold(places: Floats, held: float) -> Floats:
    """Moves the nearest place to where one is held."""
    places = places.copy()
    places[int(np.argmin(np.abs(places - held)))] = held
    return np.sort(places)
