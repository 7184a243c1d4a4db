"""Casts a grid of rays at a scene, in tiles."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import warp as wp
from numpy.typing import NDArray

from flowtree import device as devices
from flowtree.geometry.projection import NEAREST
from flowtree.kernels.cast_rays import RayGrid, cast_rays
from flowtree.render.assemble_scene import Scene

_TILE = 32  # rays along a tile's side: its part of both outputs (8 KB) stays in a core's nearest cache
_MOST_TILES = 65535  # NumPy sorts 16-bit numbers in linear time


@dataclass(frozen=True)
class ParallelView:
    """A picture by rays that run parallel, into the world, or through an eye (see `foreshorten`).

    Attributes:
        axes: (3, 3), unit vectors of the world: image-right, image-up, toward the eye.
        metres_per_pixel: [m].
        foot: (x, y) [pixels] where the world's origin projects; pixel centres lie at +0.5.
        width: [pixels].
        height: [pixels].
        samples: rays along each side of a pixel.
        distance: of the eye from the tree's axis [m]; infinite for rays that run parallel.
        eye: its height [m].
    """

    axes: NDArray[np.float64]
    metres_per_pixel: float
    foot: tuple[float, float]
    width: int
    height: int
    samples: int
    distance: float = math.inf
    eye: float = 0.0


@dataclass(frozen=True)
class RayHits:
    """What the rays of a view met.

    Attributes:
        hit: (height * samples, width * samples) int32, 1 + the triangle's index, 0 for none.
        near: of the same shape, float32, the hit's coordinate along the axis toward the eye [m],
            foreshortened like the vertices; nothing is known of misses. Empty when any hit was enough.
        corner: (n, 3) float32, the scene's vertices as (x, y) [rays] and nearness [m].
    """

    hit: NDArray[np.int32]
    near: NDArray[np.float32]
    corner: NDArray[np.float32]


def cast_scene(
    scene: Scene, view: ParallelView, *, any_hit: bool = False, device: str | None = None
) -> RayHits:
    """Finds what each ray meets first, or with ``any_hit`` only whether it meets anything.

    The rays lie on a grid, and what an eye sees is foreshortened so that they run parallel: planes stay
    planes, and what is nearer stays nearer. So no tree of boxes is needed: triangles are projected and sorted
    into square tiles of rays, and one thread casts all rays of a tile at the tile's triangles. Of two
    triangles equally near the first one in the scene wins, on any number of cores.
    """
    chosen = devices.pick_device(device)
    columns, rows = view.width * view.samples, view.height * view.samples
    corner = _project(scene, view)
    tile = _TILE
    while -(-columns // tile) * -(-rows // tile) > _MOST_TILES:
        tile *= 2
    across = -(-columns // tile)
    tile_index, tile_start, tile_triangle = _sort_into_tiles(corner, scene.triangles, columns, rows, tile)
    grid = RayGrid()
    grid.columns, grid.rows, grid.group, grid.tile, grid.tiles_across = (
        columns,
        rows,
        view.samples,
        tile,
        across,
    )
    grid.opaque = scene.wood_triangles if scene.cutoff > 0.0 else len(scene.triangles)
    grid.cutoff, grid.any_hit = scene.cutoff, int(any_hit)
    hit = devices.zeros(rows * columns, wp.int32, chosen)
    near = devices.zeros(0 if any_hit else rows * columns, wp.float32, chosen)
    devices.launch(
        cast_rays,
        len(tile_index),
        [
            devices.upload(corner, wp.vec3, chosen),
            devices.upload(scene.uvs, wp.vec2, chosen),
            devices.upload(scene.triangles, wp.vec3i, chosen),
            devices.upload(scene.alpha, wp.float32, chosen),
            devices.upload(tile_index, wp.int32, chosen),
            devices.upload(tile_start, wp.int32, chosen),
            devices.upload(tile_triangle, wp.int32, chosen),
            grid,
        ],
        [hit, near],
        device=chosen,
        split_from=2,  # a tile is much work
    )
    return RayHits(hit.numpy().reshape(rows, columns), near.numpy().reshape(-1, columns), corner)


def _project(scene: Scene, view: ParallelView) -> NDArray[np.float32]:
    """Vertices (n, 3) as (x, y) [rays], y downwards, and nearness [m], summed as in `assemble_scene`."""
    corner = np.empty((scene.positions.shape[1], 3), np.float32)
    scale = view.samples / view.metres_per_pixel
    starts: list[np.float32] = []
    rows = zip((scale, -scale, 1.0), (*view.foot, 0.0), view.axes, strict=True)
    for axis, (stretch, start, along) in enumerate(rows):
        factor = (along * stretch).astype(np.float32)
        total = factor[0] * scene.positions[0]
        total += factor[1] * scene.positions[1]
        total += factor[2] * scene.positions[2]
        corner[:, axis] = total
        starts.append(np.float32(start * view.samples))
    if math.isfinite(view.distance):
        larger = 1 / np.maximum(1 - corner[:, 2] / np.float32(view.distance), np.float32(NEAREST))
        level = np.float32(-scale * view.eye)
        corner[:, 1] -= level
        corner *= larger[:, None]
        corner[:, 1] += level
    corner += starts
    return corner


def _sort_into_tiles(
    corner: NDArray[np.float32], triangles: NDArray[np.int32], columns: int, rows: int, tile: int
) -> tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.int32]]:
    """Lists the triangles that may be met in each tile.

    Returns: the tiles that have any, where the list of each begins (one more), and the lists end to end, each
        in the scene's order.
    """
    low, high = [], []
    for axis, count in ((0, columns), (1, rows)):
        along = corner[:, axis]
        a, b, c = (along[triangles[:, k]] for k in range(3))
        low.append(np.floor(np.clip(np.minimum(np.minimum(a, b), c), -1, count)).astype(np.int32))
        high.append(np.floor(np.clip(np.maximum(np.maximum(a, b), c), -1, count)).astype(np.int32))
    seen = (high[0] >= 0) & (low[0] < columns) & (high[1] >= 0) & (low[1] < rows)
    index = np.flatnonzero(seen).astype(np.int32)
    left, upper = (np.maximum(part[index], 0) // tile for part in low)
    right = np.minimum(high[0][index], columns - 1) // tile
    lower = np.minimum(high[1][index], rows - 1) // tile
    wide = right - left + 1
    count = wide * (lower - upper + 1)
    owner = np.repeat(np.arange(len(index)), count)
    within = np.arange(len(owner)) - np.repeat(np.cumsum(count) - count, count)
    across, down = -(-columns // tile), -(-rows // tile)
    place = (upper[owner] + within // wide[owner]) * across + left[owner] + within % wide[owner]
    # Shuffled, because each core gets one run of the list and the crown is all in the upper rows.
    shuffled = np.random.default_rng(0).permutation(across * down)
    key = np.argsort(shuffled)[place]
    order = np.argsort(key.astype(np.uint16), kind="stable")
    sizes = np.bincount(key, minlength=1)
    used = np.flatnonzero(sizes)
    start = np.concatenate([[0], np.cumsum(sizes[used])]).astype(np.int32)
    return shuffled[used].astype(np.int32), start, index[owner[order]]
