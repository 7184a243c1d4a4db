"""The float64 twin of `flowtree.kernels.pair_nearest`."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray


def pair_nearest(
    first: int,
    position: NDArray[Any],
    mass: NDArray[Any],
    nearest: NDArray[Any],
    reach: float,
    host_out: NDArray[Any],
    nearest_out: NDArray[Any],
) -> None:
    """Of two that are each other's nearest, the lighter (of equal mass: the later) goes to the other."""
    place = np.asarray(position, np.float64)
    for i in range(first, len(mass)):
        j = int(nearest[i])
        mutual = j >= 0 and nearest[j] == i and np.linalg.norm(place[j] - place[i]) < reach
        goes = mutual and (float(mass[j]), -j) > (float(mass[i]), -i)
        host_out[i] = j if goes else -1
        nearest_out[i] = -1 if mutual and not goes else j
