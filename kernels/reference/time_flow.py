"""The float64 twin of `flowtree.kernels.time_flow`: one start after the other."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from flowtree.kernels.reference.flow_fields import flow_direction, normalize


def time_flow(
    first: int,
    start: NDArray[Any],
    fields: Any,
    step: float,
    arrival: float,
    limit: int,
    time_out: NDArray[Any],
) -> None:
    """Follows the fields at unit speed with the midpoint rule and measures the way."""
    for i in range(first, len(start)):
        at = np.asarray(start[i], np.float64)
        count = 0
        while count < limit and np.linalg.norm(at) > arrival:
            middle = at + 0.5 * step * normalize(flow_direction(fields, at))
            at = at + step * normalize(flow_direction(fields, middle))
            count += 1
        time_out[i] = count * step + np.linalg.norm(at)
