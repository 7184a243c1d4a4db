"""The float64 twin of `flowtree.kernels.find_nearest`: everybody against everybody."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray


def find_nearest(
    first: int,
    position: NDArray[Any],
    mass: NDArray[Any],
    state: NDArray[Any],
    index: NDArray[Any],
    begin: NDArray[Any],
    grid: Any,
    radius: float,
    reach: float,
    growth: float,
    nearest_out: NDArray[Any],
    host_out: NDArray[Any],
) -> None:
    """Looks at every pair; the cell list, only speed, is ignored. The order of equals is the kernel's."""
    del index, begin, grid
    position = np.asarray(position, np.float64)
    for i in range(first, len(position)):
        nearest_out[i] = host_out[i] = -1
        if state[i] != 1:
            continue
        others = [j for j in np.flatnonzero(state == 1) if j != i]
        square = {j: float(np.sum((position[j] - position[i]) ** 2)) for j in others}
        near = [(square[j], j) for j in others if square[j] <= radius * radius]
        if near:
            nearest_out[i] = min(near)[1]
        hosts = []
        for j in others:
            threshold = min(reach + growth * (np.sqrt(float(mass[i]) + float(mass[j])) - 1.0), radius)
            heavier = mass[j] > mass[i] or (mass[j] == mass[i] and j < i)
            if heavier and square[j] <= threshold * threshold:
                hosts.append((square[j] / (threshold * threshold), j))
        if hosts:
            host_out[i] = min(hosts)[1]
