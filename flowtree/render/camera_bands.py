"""A camera's rays, in bands of rows that bound the memory."""

from __future__ import annotations

from collections.abc import Iterator
from math import isfinite

import numpy as np

from flowtree import check
from flowtree.geometry.projection import view_axes
from flowtree.model.camera import Camera
from flowtree.render.cast_scene import ParallelView

_MOST_RAYS = 3_000_000  # in one band: shading its hits takes up to 250 MB
_MOST_PIXELS = 16384


def camera_bands(camera: Camera, samples: int) -> Iterator[tuple[slice, ParallelView]]:
    """The rows of the picture and the rays through them, band by band from the top.

    Args:
        camera: of the picture.
        samples: rays along each side of a pixel.

    Raises:
        InputError: a camera that makes no picture, or ``samples`` out of 1 to 8.
    """
    numbers = (camera.yaw, camera.metres_per_pixel, *camera.foot)
    check.require(
        all(isfinite(number) for number in numbers), "camera", "must be finite", numbers, "pass numbers"
    )
    scale = camera.metres_per_pixel
    check.require(scale > 0, "camera.metres_per_pixel", "must be above 0", scale, "pass metres in a pixel")
    sides = (camera.width, camera.height)
    fits = all(1 <= side <= _MOST_PIXELS for side in sides)
    check.require(
        fits, "camera", f"must have 1 to {_MOST_PIXELS} pixels a side", sides, "choose another picture size"
    )
    check.require(1 <= samples <= 8, "samples", "must be 1 to 8", samples, "choose one of those")
    rows = max(1, _MOST_RAYS // (camera.width * samples * samples))
    axes = np.stack(view_axes(camera.yaw))
    sight = (camera.distance, camera.eye)
    for top in range(0, camera.height, rows):
        part = slice(top, min(top + rows, camera.height))
        foot = (camera.foot[0], camera.foot[1] - top)
        yield part, ParallelView(axes, scale, foot, camera.width, part.stop - top, samples, *sight)
