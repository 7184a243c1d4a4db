"""The part of the trunk that no leaf hides."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flowtree.geometry.parent_array import main_child
from flowtree.geometry.polylines import arc_lengths
from flowtree.model.skeleton import Skeleton

_LOWEST = 0.3  # share of the height: above it leaves hide the trunk


def lower_trunk(skeleton: Skeleton, count: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Points (count, 3) [m] evenly along the thickest way up from the root, and the radius at each [m]."""
    child = main_child(skeleton.parent, skeleton.radius)
    path = [0]
    while child[path[-1]] >= 0:
        path.append(int(child[path[-1]]))
    points, radius = skeleton.points[path].astype(np.float64), skeleton.radius[path].astype(np.float64)
    along = arc_lengths(points)
    high = points[:, 1] > _LOWEST * float(skeleton.points[:, 1].max())
    end = along[int(np.argmax(high))] if high.any() else along[-1]
    places = np.linspace(0.0, end, count)
    line = np.stack([np.interp(places, along, points[:, k]) for k in range(3)], axis=1)
    return line, np.interp(places, along, radius)
