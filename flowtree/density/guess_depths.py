"""A guess of the depths that a view does not know."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def guess_depths(depth: NDArray[np.float64], known: NDArray[np.bool_]) -> NDArray[np.float64]:
    """The depths with what is not known as it is on the other side of the tree, or else as it is beside it.

    Args:
        depth: (columns, rows), the tree's axis in the middle.
        known: (columns, rows).

    Returns: (columns, rows); a row of which nothing is known stays as it is.
    """
    if known.all():
        return depth
    mirrored, sure = depth[::-1], known[::-1]
    guessed = np.where(known, depth, np.where(sure, mirrored, 0.0))
    rest = ~(known | sure)
    place = np.arange(len(depth))
    for row in np.flatnonzero(rest.any(axis=0) & ~rest.all(axis=0)):
        hidden = rest[:, row]
        guessed[hidden, row] = np.interp(place[hidden], place[~hidden], guessed[~hidden, row])
    return guessed
