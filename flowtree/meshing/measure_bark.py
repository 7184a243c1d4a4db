"""The bark's colour, from the photographs."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from flowtree.geometry.projection import project
from flowtree.meshing.lower_trunk import lower_trunk
from flowtree.model.camera import Camera
from flowtree.model.matte import Matte
from flowtree.model.skeleton import Skeleton

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
    line, radius = lower_trunk(skeleton, _SAMPLES)
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
