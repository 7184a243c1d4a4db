"""How large something looks that is known by points."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from flowtree.geometry.projection import Viewpoint, to_plane

_YAWS = (0.0, 45.0, 90.0, 135.0)  # [degrees]


def shadow_area(points: NDArray[np.floating[Any]], cell: float) -> float:
    """The area [m²] of square cells that points (n, 3) [m] fall into, seen from the side.

    Args:
        points: world frame.
        cell: [m]; of the order of the points' distances, or the gaps between them show.

    Returns: the mean over four views around.
    """
    counts = []
    for yaw in _YAWS:
        place = np.floor(to_plane(points, Viewpoint(yaw)) / cell).astype(np.int64)
        counts.append(len(np.unique(place, axis=0)))
    return float(np.mean(counts)) * cell**2
