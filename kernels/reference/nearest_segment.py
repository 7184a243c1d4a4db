"""The float64 twin of `flowtree.kernels.nearest_segment`: every point against every segment."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray


def nearest_segment(
    first: int,
    place: NDArray[Any],
    start: NDArray[Any],
    along: NDArray[Any],
    over: NDArray[Any],
    low: NDArray[Any],
    high: NDArray[Any],
    run: int,
    segment_out: NDArray[Any],
) -> None:
    """The nearest segment of each point; the boxes, only speed, are ignored."""
    del low, high, run
    start, along = np.asarray(start, np.float64), np.asarray(along, np.float64)
    for i in range(first, len(place)):
        gap = np.asarray(place[i], np.float64) - start
        fraction = np.clip((gap * along).sum(axis=1) * over, 0.0, 1.0)
        segment_out[i] = ((gap - fraction[:, None] * along) ** 2).sum(axis=1).argmin()
