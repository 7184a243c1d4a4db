"""The float64 twin of `flowtree.kernels.flow_fields`: one point at a time, structs of NumPy arrays."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray


def normalize(vector: NDArray[Any]) -> NDArray[Any]:
    """The unit vector, or 0 for 0, as Warp has it."""
    length = np.linalg.norm(vector)
    return vector / length if length > 0.0 else np.zeros_like(vector)


def sample_box(values: NDArray[Any], corner: NDArray[Any], spacing: float, at: NDArray[Any]) -> Any:
    """Trilinear value of a box of points; outside it takes the value at the border."""
    top = np.array(values.shape[:3]) - 1.001
    place = np.clip((at - np.asarray(corner, np.float64)) / spacing, 0.0, top)
    low = place.astype(int)
    share = place - low
    total = 0.0
    for corner_of in np.ndindex(2, 2, 2):
        weight = np.prod(np.where(corner_of, share, 1.0 - share))
        total = total + weight * np.asarray(values[tuple(low + corner_of)], np.float64)
    return total


def seen_larger(toward: NDArray[Any], at: NDArray[Any]) -> float:
    """How many times as large as at the tree's axis an eye sees what is there; 1 in a parallel projection."""
    return float(1.0 / max(1.0 - np.asarray(toward, np.float64) @ at, 0.1))


def view_vector(fields: Any, view: int, at: NDArray[Any]) -> NDArray[Any]:
    """Bilinear value of one view's field; points outside take the value at its border."""
    rows, columns = fields.vectors.shape[1:3]
    larger, eye = seen_larger(fields.toward[view], at), fields.eye[view]
    plane = np.array([fields.right[view] @ at * larger, eye + (at[1] - eye) * larger])
    place = (plane - fields.corner[view]) / fields.cell[view] - 0.5
    u, v = np.clip(place, 0.0, [columns - 1, rows - 1])
    j, i = min(int(u), columns - 2), min(int(v), rows - 2)
    a, b = u - j, v - i
    vectors = np.asarray(fields.vectors[view], np.float64)
    low = vectors[i, j] * (1.0 - a) + vectors[i, j + 1] * a
    high = vectors[i + 1, j] * (1.0 - a) + vectors[i + 1, j + 1] * a
    return np.asarray(low * (1.0 - b) + high * b)


def route_vector(fields: Any, at: NDArray[Any]) -> NDArray[Any]:
    """Trilinear value of the route; points outside take the value at its border."""
    return np.asarray(sample_box(fields.route, fields.route_corner, fields.route_spacing, at))


def follow_route(fields: Any, at: NDArray[Any], along: NDArray[Any]) -> NDArray[Any]:
    """The fields' direction, and where it leads away from the route, the route: a unit vector."""
    route = route_vector(fields, at)
    solid = np.clip(2.0 - np.linalg.norm(route), 0.0, 1.0)
    route = normalize(route)
    trust = np.clip(0.5 + 0.5 * (along @ route) / fields.pull, 0.0, 1.0) * solid
    return normalize(along * trust + route * (1.0 - trust))


def turn_to_foot(fields: Any, at: NDArray[Any], along: NDArray[Any]) -> NDArray[Any]:
    """A direction that gives way to the straight way to the foot near it and under the ground."""
    near = min(float(np.linalg.norm(at)) / fields.basin, 1.0)
    free = near * np.clip(1.0 + at[1] / fields.basin, 0.0, 1.0)
    return np.asarray(along * free - normalize(at) * (1.0 - free))


def flow_direction(fields: Any, at: NDArray[Any]) -> NDArray[Any]:
    """Where a particle wants to go: the views' vectors on average, mixed with the route if there is one."""
    total = np.zeros(3)
    for view in range(fields.vectors.shape[0]):
        across, up = view_vector(fields, view, at)
        total = total + np.asarray(fields.right[view], np.float64) * across + [0.0, up, 0.0]
    along = normalize(np.asarray(fields.combine, np.float64).reshape(3, 3) @ total)
    if fields.pull > 0.0:
        along = follow_route(fields, at, along)
    return turn_to_foot(fields, at, along)
