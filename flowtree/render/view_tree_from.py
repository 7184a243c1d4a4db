"""What a tree is made of, seen from one side: colours without light, normals, alpha."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from flowtree.render.assemble_scene import Scene
from flowtree.render.cast_scene import ParallelView, RayHits, cast_scene
from flowtree.render.interpolate_hits import (
    corner_weights,
    look_up_texture,
    ray_places,
    spread_values,
    texture_level,
)
from flowtree.render.sample_texture import build_pyramid

_RAYS = 1 << 19  # averaged at once: what is worked out of them stays small

Floats = NDArray[np.float32]
Pyramids = tuple[list[NDArray[np.float32]], list[NDArray[np.float32]]]


@dataclass(frozen=True)
class Surface:
    """A picture of what can be lit later.

    Attributes:
        color: (h, w, 3) float32, linear, of what is seen, not multiplied with alpha; 0 where nothing is.
        normal: (h, w, 3) float32, unit, as (right, up, toward the eye); toward the eye where nothing is.
        alpha: (h, w) float32 in 0..1, the share of each pixel that is tree.
        depth: (h, w) float32 [m], how far what is seen lies toward the eye, from the origin on; 0 where
            nothing is.
    """

    color: NDArray[np.float32]
    normal: NDArray[np.float32]
    alpha: NDArray[np.float32]
    depth: NDArray[np.float32]


def texture_pyramids(scene: Scene) -> Pyramids:
    """The bark's and the leaves' textures in all sizes: the same for all views."""
    return build_pyramid(scene.bark.base_color), [] if scene.leaf is None else build_pyramid(
        scene.leaf.base_color
    )


def view_tree_from(
    scene: Scene, view: ParallelView, pyramids: Pyramids, *, device: str | None = None
) -> Surface:
    """Casts the view's rays and averages what those of each pixel meet.

    Leaves have two sides: the normal is that of the side that is seen. The bark's own relief is left out, it
    is finer than a pixel.

    Args:
        scene: the triangles.
        view: the rays.
        pyramids: of the scene's textures, see `texture_pyramids`.
        device: to run on.
    """
    hits = cast_scene(scene, view, device=device)
    toward_eye = view.axes[2].astype(np.float32) @ scene.positions
    values = np.concatenate([scene.colors, scene.uvs, scene.normals.T, toward_eye[:, None]], axis=1)
    rows = max(1, _RAYS // (view.width * view.samples**2))
    bands = [
        _average_band(scene, view, pyramids, hits, values, slice(first, min(first + rows, view.height)))
        for first in range(0, view.height, rows)
    ]
    color, normal, alpha, depth = (np.concatenate(parts) for parts in zip(*bands, strict=True))
    return Surface(color, normal, alpha, depth)


def _average_band(
    scene: Scene, view: ParallelView, pyramids: Pyramids, hits: RayHits, values: Floats, rows: slice
) -> tuple[Floats, Floats, Floats, Floats]:
    """Some rows of the picture, as in `Surface`; values (n, 9) of vertices."""
    samples, columns = view.samples, view.width * view.samples
    first = rows.start * samples * columns
    band = hits.hit[rows.start * samples : rows.stop * samples].ravel()
    ray = np.flatnonzero(band)
    triangle = band[ray] - 1
    x, y = ray_places(ray + first, columns, samples)
    # Every triangle's texture level would be worked out: only those that are met are worth it.
    met, place = np.unique(triangle, return_inverse=True)
    corners = np.take(scene.triangles, triangle, axis=0).T
    spread = spread_values(values, corners, corner_weights(hits.corner, corners, x, y))
    color, uv, normal = spread[:, :3], spread[:, 3:5], spread[:, 5:8] @ view.axes.T.astype(np.float32)
    level = texture_level(replace(scene, triangles=scene.triangles[met]), hits.corner)[place]
    wood = triangle < scene.wood_triangles
    for chosen, pyramid in zip((wood, ~wood), pyramids, strict=True):
        if chosen.any():
            color[chosen] *= look_up_texture(pyramid, uv[chosen], level[chosen])
    normal *= np.where(normal[:, 2:] < 0, np.float32(-1), np.float32(1))
    row, column = np.divmod(ray, columns)
    pixel = row // samples * view.width + column // samples
    shape = (rows.stop - rows.start, view.width)
    count = np.bincount(pixel, minlength=shape[0] * shape[1])
    mean = _means(pixel, color, count).reshape(*shape, 3)
    facing = _means(pixel, normal, count)
    length = np.linalg.norm(facing, axis=1, keepdims=True)
    toward = np.tile(np.array([0.0, 0.0, 1.0]), (len(facing), 1))
    np.divide(facing, length, out=toward, where=length > 1e-6)
    return (
        mean.astype(np.float32),
        toward.reshape(*shape, 3).astype(np.float32),
        (count / samples**2).reshape(shape).astype(np.float32),
        _means(pixel, spread[:, 8:], count).reshape(shape).astype(np.float32),
    )


def _means(
    pixel: NDArray[np.intp], values: NDArray[np.float32], count: NDArray[np.intp]
) -> NDArray[np.float64]:
    """The mean (pixels, 3) of what the rays of each pixel met; 0 where they met nothing."""
    total = [np.bincount(pixel, part, minlength=len(count)) for part in values.T]
    return np.stack(total, axis=1) / np.maximum(count, 1)[:, None]
