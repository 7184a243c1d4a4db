"""The views' direction fields and the route, as the kernels read them (Particle Flows, section 7)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import warp as wp
from numpy.typing import NDArray

from flowtree import device as devices
from flowtree.geometry.projection import view_axes
from flowtree.kernels.flow_fields import FlowFields
from flowtree.model.field import DirectionField


def upload_fields(
    fields: Sequence[DirectionField],
    route: tuple[NDArray[np.float32], NDArray[np.float32], float] | None = None,
    *,
    pull: float = 0.0,
    basin: float,
    device: str,
) -> FlowFields:
    """Puts fields of equal resolution on the device.

    A component of the world vector is averaged over the views that see it. A plain average, as the paper has
    it, halves what only one view sees, and every branch comes out steeper than it was drawn.

    Args:
        fields: one a view.
        route: what `route_to_foot` returns; None for the fields alone.
        pull: cosine between field and route above which the field alone is followed; needs a route.
        basin: nearer to the foot than this, the straight way to it takes over [m].
        device: where the kernels run.
    """
    rights = np.array([view_axes(field.yaw)[0] for field in fields])
    up = np.array([0.0, 1.0, 0.0])
    seen = sum(np.outer(right, right) + np.outer(up, up) for right in rights)
    flow = FlowFields()
    flow.vectors = devices.upload(np.stack([f.vectors for f in fields]).astype(np.float32), wp.vec2, device)
    flow.corner = devices.upload(np.stack([f.origin for f in fields]).astype(np.float32), wp.vec2, device)
    flow.cell = devices.upload(np.stack([f.cell for f in fields]).astype(np.float32), wp.vec2, device)
    flow.right = devices.upload(rights.astype(np.float32), wp.vec3, device)
    flow.combine = wp.mat33(*np.linalg.pinv(seen).ravel().tolist())
    nowhere = np.zeros((2, 2, 2, 3), np.float32), np.zeros(3, np.float32), 1.0
    way, corner, spacing = nowhere if route is None else route
    flow.route = devices.upload(way, wp.vec3, device)
    flow.route_corner = wp.vec3(*map(float, corner))
    flow.route_spacing = spacing
    flow.pull = pull if route is not None else 0.0
    flow.basin = basin
    return flow
