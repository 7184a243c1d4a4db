"""Which share of some lines has wood near them, as a view shows it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from flowtree.geometry.projection import Viewpoint, to_plane
from flowtree.model.skeleton import Skeleton

_STEP = 0.002  # between two samples of a line [tree heights]


@dataclass(frozen=True)
class Samples:
    """Places along lines.

    Attributes:
        points: (n, 2) in a view's plane, or (n, 3) in the world [m].
        radius: (n,) [m].
        length: (n,) of line that each stands for [m].
    """

    points: NDArray[np.float64]
    radius: NDArray[np.float64]
    length: NDArray[np.float64]

    def at_least(self, radius: float) -> Samples:
        """Those of lines that thick [m]."""
        thick = self.radius >= radius
        return Samples(self.points[thick], self.radius[thick], self.length[thick])

    def seen_from(self, yaw: float) -> Samples:
        """The same in the plane of a view; a line that runs toward it is as long as in the world."""
        return Samples(to_plane(self.points, Viewpoint(yaw)), self.radius, self.length)


def sample_lines(
    start: NDArray[np.float64],
    end: NDArray[np.float64],
    radii: NDArray[np.float64],
    height: float,
) -> Samples:
    """Places in the middle of equal pieces of every segment.

    Args:
        start: (n, d) [m].
        end: (n, d) [m].
        radii: (n, 2) at the two ends [m].
        height: of the tree [m].
    """
    along = end - start
    length = np.linalg.norm(along, axis=1)
    count = np.maximum(np.ceil(length / (_STEP * height)), 1).astype(int)
    which = np.repeat(np.arange(len(start)), count)
    number = np.arange(int(count.sum())) - np.repeat(np.cumsum(count) - count, count)
    share = (number + 0.5) / count[which]
    radius = radii[which, 0] * (1 - share) + radii[which, 1] * share
    return Samples(start[which] + along[which] * share[:, None], radius, (length / count)[which])


def sample_wood(skeleton: Skeleton, height: float, *, twigs: bool) -> Samples:
    """Places along a tree's wood, in the world; with or without the small twigs of the twig rule."""
    nodes = np.flatnonzero(skeleton.parent >= 0)
    if not twigs:
        nodes = nodes[~skeleton.twig[nodes]]
    above = skeleton.parent[nodes]
    points = skeleton.points.astype(np.float64)
    radii = np.stack([skeleton.radius[above], skeleton.radius[nodes]], axis=1).astype(np.float64)
    return sample_lines(points[above], points[nodes], radii, height)


def share_near(lines: Samples, wood: Samples, reach: float) -> float:
    """The share of the lines' length that has wood within ``reach`` [m]; 1 for lines without length."""
    total = float(lines.length.sum())
    if total == 0.0:
        return 1.0
    if not len(wood.points):
        return 0.0
    away, _ = cKDTree(wood.points).query(lines.points, distance_upper_bound=reach)
    return float(lines.length[np.isfinite(away)].sum()) / total
