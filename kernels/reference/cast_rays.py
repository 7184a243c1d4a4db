"""The float64 twin of `flowtree.kernels.cast_rays`: every ray against every triangle."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray


def sample_alpha(alpha: NDArray[Any], at: NDArray[Any]) -> NDArray[Any]:
    """The texture's alpha (h, w) at (n, 2) coordinates between its texel centres; the texture repeats."""
    rows, columns = alpha.shape
    x, y = (at[:, 0] % 1.0) * columns - 0.5, (at[:, 1] % 1.0) * rows - 0.5
    left, upper = np.floor(x).astype(int), np.floor(y).astype(int)
    fx, fy = x - left, y - upper
    i, j, i_next, j_next = left % columns, upper % rows, (left + 1) % columns, (upper + 1) % rows
    top = alpha[j, i] * (1.0 - fx) + alpha[j, i_next] * fx
    bottom = alpha[j_next, i] * (1.0 - fx) + alpha[j_next, i_next] * fx
    return top * (1.0 - fy) + bottom * fy


def cast_rays(
    first: int,
    corner: NDArray[Any],
    uv: NDArray[Any],
    triangle: NDArray[Any],
    alpha: NDArray[Any],
    tile_index: NDArray[Any],
    tile_start: NDArray[Any],
    tile_triangle: NDArray[Any],
    grid: Any,
    hit_out: NDArray[Any],
    near_out: NDArray[Any],
) -> None:
    """Casts the rays of the listed tiles; the sorting of triangles into tiles, only speed, is ignored."""
    del tile_start, tile_triangle
    corner, uv = np.asarray(corner, np.float64), np.asarray(uv, np.float64)
    for place in tile_index[first:]:
        left, upper = (place % grid.tiles_across) * grid.tile, (place // grid.tiles_across) * grid.tile
        right, lower = min(left + grid.tile, grid.columns), min(upper + grid.tile, grid.rows)
        row, column = (part.ravel() for part in np.mgrid[upper:lower, left:right])
        x = column + ((row % grid.group) + 0.5) / grid.group
        y = row + ((column % grid.group) + 0.5) / grid.group
        ray = row * grid.columns + column
        for t, of in enumerate(triangle):
            a, b, c = corner[of[0]], corner[of[1]] - corner[of[0]], corner[of[2]] - corner[of[0]]
            area = b[0] * c[1] - b[1] * c[0]
            if area == 0.0:
                continue
            wb = ((x - a[0]) * c[1] - (y - a[1]) * c[0]) / area
            wc = ((y - a[1]) * b[0] - (x - a[0]) * b[1]) / area
            near = a[2] + wb * b[2] + wc * c[2]
            solid = (wb >= 0.0) & (wc >= 0.0) & (wb + wc <= 1.0)
            if t >= grid.opaque:
                ua = uv[of[0]]
                at = ua + wb[:, None] * (uv[of[1]] - ua) + wc[:, None] * (uv[of[2]] - ua)
                solid &= sample_alpha(alpha, at) >= grid.cutoff
            solid &= (hit_out[ray] == 0) | ((near > near_out[ray]) if grid.any_hit == 0 else False)
            hit_out[ray[solid]] = t + 1
            if grid.any_hit == 0:
                near_out[ray[solid]] = near[solid]
