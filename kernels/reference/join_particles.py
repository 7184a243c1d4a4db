"""The float64 twin of `flowtree.kernels.join_particles`: every host looks for its guests among all."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray


def join_particles(
    first: int,
    position: NDArray[Any],
    velocity: NDArray[Any],
    mass: NDArray[Any],
    state: NDArray[Any],
    host: NDArray[Any],
    index: NDArray[Any],
    begin: NDArray[Any],
    grid: Any,
    reach: float,
    growth: float,
    now: int,
    position_out: NDArray[Any],
    velocity_out: NDArray[Any],
    mass_out: NDArray[Any],
    state_out: NDArray[Any],
    joined_out: NDArray[Any],
    end_step_out: NDArray[Any],
) -> None:
    """Takes every particle over into its host; the cell list and the reach, only speed, are ignored."""
    del index, begin, grid, reach, growth
    for i in range(first, len(mass)):
        position_out[i], velocity_out[i] = position[i], velocity[i]
        mass_out[i], state_out[i] = mass[i], state[i]
        if state[i] != 1:
            continue
        if host[i] >= 0:
            if host[host[i]] < 0:
                state_out[i], joined_out[i], end_step_out[i] = 2, host[i], now
            continue
        both = np.concatenate([[i], np.flatnonzero((host == i) & (state == 1))])
        if len(both) > 1:
            weight = np.asarray(mass[both], np.float64)
            mass_out[i] = weight.sum()
            position_out[i] = weight @ np.asarray(position[both], np.float64) / weight.sum()
            velocity_out[i] = weight @ np.asarray(velocity[both], np.float64) / weight.sum()
