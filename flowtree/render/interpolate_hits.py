"""Between the corners of the triangles that rays have met."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from flowtree.render.assemble_scene import Scene
from flowtree.render.sample_texture import sample_texture


def ray_places(
    ray: NDArray[np.integer[Any]], columns: int, samples: int
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Where rays pass through the picture: x and y (n,) [rays], see `RayGrid`.

    Args:
        ray: (n,) flat indices.
        columns: rays in a row.
        samples: rays along each side of a pixel.
    """
    row, column = np.divmod(ray, columns)
    x = (column + (row % samples + 0.5) / samples).astype(np.float32)
    y = (row + (column % samples + 0.5) / samples).astype(np.float32)
    return x, y


def corner_weights(
    corner: NDArray[np.float32], of: NDArray[np.int32], x: NDArray[np.float32], y: NDArray[np.float32]
) -> NDArray[np.float32]:
    """Barycentric weights (3, n) of the points on their triangles' corners (3, n)."""
    flat = [np.ascontiguousarray(corner[:, axis]) for axis in (0, 1)]
    ax, ay = (np.take(part, of[0]) for part in flat)
    bx, by, cx, cy = (np.take(flat[k % 2], of[1 + k // 2]) - (ax, ay)[k % 2] for k in range(4))
    dx, dy = x - ax, y - ay
    weight = np.empty((3, len(x)), np.float32)
    area = bx * cy - by * cx
    weight[1], weight[2] = (dx * cy - dy * cx) / area, (dy * bx - dx * by) / area
    weight[0] = 1 - weight[1] - weight[2]
    return weight


def spread_values(
    values: NDArray[np.float32], of: NDArray[np.int32], weight: NDArray[np.float32]
) -> NDArray[np.float32]:
    """The vertices' values (n, k) between the corners (3, n), with their weights (3, n)."""
    total = np.zeros((of.shape[1], values.shape[1]), np.float32)
    for corner in range(3):
        part = np.take(values, of[corner], axis=0)
        part *= weight[corner][:, None]
        total += part
    return total


def texture_level(scene: Scene, corner: NDArray[np.float32]) -> NDArray[np.float32]:
    """How often each triangle's texture of one texel must be halved to a texel a ray (usually negative)."""
    areas = []
    for points in (scene.uvs, corner):
        a, b, c = (points[scene.triangles[:, k], :2] for k in range(3))
        twice = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
        areas.append(np.abs(twice) + np.float32(1e-12))
    level = np.empty(len(areas[0]), np.float32)
    level[:] = 0.5 * np.log2(areas[0] / areas[1])
    return level


def look_up_texture(
    pyramid: list[NDArray[np.float32]], uv: NDArray[np.float32], level: NDArray[np.float32]
) -> NDArray[np.float32]:
    """The texture at (n, 2) coordinates, from the level that suits each ray."""
    size = 0.5 * np.log2(pyramid[0].shape[0] * pyramid[0].shape[1])
    number = np.clip(np.rint(level + size), 0, len(pyramid) - 1).astype(np.int8)
    return sample_texture(pyramid, uv, number)
