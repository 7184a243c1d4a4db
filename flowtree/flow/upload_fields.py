"""The views' direction fields and the route, as the kernels read them (Particle Flows, section 7)."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import Any

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
    rights, towards, combine = _look_from(tuple((field.yaw, field.distance) for field in fields))
    flow = FlowFields()
    flow.vectors = devices.hand_over(
        np.stack([f.vectors for f in fields]).astype(np.float32, copy=False), wp.vec2, device
    )
    flow.corner = devices.hand_over(np.stack([f.origin for f in fields]).astype(np.float32), wp.vec2, device)
    flow.cell = devices.hand_over(np.stack([f.cell for f in fields]).astype(np.float32), wp.vec2, device)
    flow.right = devices.hand_over(rights, wp.vec3, device)
    flow.toward = devices.hand_over(towards, wp.vec3, device)
    flow.eye = devices.hand_over(np.array([f.eye for f in fields], np.float32), wp.float32, device)
    flow.combine = combine
    if route is None:
        flow.route, flow.route_spacing = _nowhere(device), 1.0
    else:
        way, corner, flow.route_spacing = route
        flow.route = devices.upload(way, wp.vec3, device)
        flow.route_corner = wp.vec3(*map(float, corner))
        flow.pull = pull
    flow.basin = basin
    return flow


@lru_cache(maxsize=16)
def _look_from(
    sights: tuple[tuple[float, float], ...],
) -> tuple[NDArray[np.float32], NDArray[np.float32], Any]:
    """What the kernels know of views at yaws [degrees] and distances [m].

    Returns: (views, 3) image-right of each; (views, 3) toward the eye over its distance; what averages a sum
        of the views' vectors component by component.
    """
    rights = np.array([view_axes(yaw)[0] for yaw, _ in sights])
    towards = np.array([view_axes(yaw)[2] / distance for yaw, distance in sights])
    up = np.array([0.0, 1.0, 0.0])
    seen = sum(np.outer(right, right) + np.outer(up, up) for right in rights)
    return (
        rights.astype(np.float32),
        towards.astype(np.float32),
        wp.mat33(*np.linalg.pinv(seen).ravel().tolist()),
    )


@lru_cache(maxsize=4)
def _nowhere(device: str) -> Any:
    """A route that is never followed."""
    return devices.zeros((2, 2, 2), wp.vec3, device)
