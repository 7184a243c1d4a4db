"""The bark's colour, from the photographs."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from flowtree.geometry.projection import project
from flowtree.model.camera import Camera
from flowtree.model.matte import Matte
from flowtree.model.skeleton import Skeleton

_LOWEST = 0.3  # share of the height: above it leaves hide the trunk
_SAMPLES = 64  # along the trunk
_INNER = 0.5  # share of the trunk's width that is surely trunk
_SOLID = 0.7  # alpha
_FEWEST = 12  # pixels
# Grey brown, for a tree whose trunk no photo shows.
_PLAIN = (112.0, 98.0, 84.0)


def measure_bark(
    skeleton: Skeleton, mattes: Sequence[Matte], cameras: Sequence[Camera]
) -> NDArray[np.float64]:
    """The median foreground colour where the lower trunk projects.

    Greenish pixels (grass or leaves before the trunk) count only where there is nothing else.

    Args:
        skeleton: with radii [m].
        mattes: one a view, with the tree's own colours.
        cameras: one a view.

    Returns: (3,) sRGB, 0..255; a grey brown where no view shows a trunk.
    """
    line, radius = _lower_trunk(skeleton)
    colors = []
    for matte, camera in zip(mattes, cameras, strict=True):
        centre = project(line, camera)
        across = np.linspace(-_INNER, _INNER, 7)
        x = centre[:, :1] + across * (radius / camera.metres_per_pixel)[:, None]
        y = np.broadcast_to(centre[:, 1:], x.shape)
        column, row = np.floor(x).astype(int).ravel(), np.floor(y).astype(int).ravel()
        inside = (column >= 0) & (column < camera.width) & (row >= 0) & (row < camera.height)
        place = np.unique(row[inside] * camera.width + column[inside])
        solid = matte.alpha.ravel()[place] >= _SOLID
        colors.append(matte.foreground.reshape(-1, 3)[place[solid]])
    seen = np.concatenate(colors).astype(np.float64) if colors else np.zeros((0, 3))
    green = (seen[:, 1] > seen[:, 0] + 4.0) & (seen[:, 1] > seen[:, 2] + 4.0)
    if int((~green).sum()) >= _FEWEST:
        seen = seen[~green]
    return np.asarray(np.median(seen, axis=0) if len(seen) >= _FEWEST else _PLAIN, np.float64)


def _lower_trunk(skeleton: Skeleton) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Points (k, 3) [m] evenly along the thickest way up from the root, and the radius at each [m]."""
    path = [0]
    best = np.full(len(skeleton.parent), -1)
    for child in (
        np.argsort(skeleton.radius[1:], kind="stable") + 1
    ):  # the thickest child comes last and stays
        best[skeleton.parent[child]] = child
    while best[path[-1]] >= 0:
        path.append(int(best[path[-1]]))
    points, radius = skeleton.points[path].astype(np.float64), skeleton.radius[path].astype(np.float64)
    along = np.concatenate(([0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))))
    high = points[:, 1] > _LOWEST * float(skeleton.points[:, 1].max())
    end = along[int(np.argmax(high))] if high.any() else along[-1]
    places = np.linspace(0.0, end, _SAMPLES)
    line = np.stack([np.interp(places, along, points[:, k]) for k in range(3)], axis=1)
    return line, np.interp(places, along, radius)
