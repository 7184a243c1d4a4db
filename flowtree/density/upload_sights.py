"""From where views look, as the kernels read it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import warp as wp

from flowtree import device as devices
from flowtree.geometry.projection import Sight, view_axes
from flowtree.kernels.fit_sights import SightViews


def upload_sights(
    sights: Sequence[Sight], *, left: float, cell: float, corner: float, device: str
) -> SightViews:
    """Puts views of one size on the device.

    Args:
        sights: of the views.
        left: image-right coordinate of the pictures' first line [m].
        cell: edge of a picture's cell and of a voxel [m].
        corner: x and z of the box's lowest corner, which lies on the ground [m].
        device: where the kernels run.
    """
    axes = [view_axes(sight.yaw) for sight in sights]

    def put(values: list[Any], kind: Any) -> Any:
        return devices.upload(np.array(values, np.float32), kind, device)

    views = SightViews()
    views.right = put([each[0] for each in axes], wp.vec3)
    views.toward = put([each[2] for each in axes], wp.vec3)
    views.closeness = put([1.0 / sight.distance for sight in sights], wp.float32)
    views.eye = put([sight.eye for sight in sights], wp.float32)
    views.left, views.cell, views.corner = left, cell, wp.vec3(corner, 0.0, corner)
    return views
