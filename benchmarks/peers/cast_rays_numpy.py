"""Rays at triangles with NumPy: every triangle's box of rays at once, then the nearest hit of every ray."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flowtree.kernels.reference.cast_rays import sample_alpha
from flowtree.render.assemble_scene import Scene

_AT_ONCE = 1_000_000  # rays in boxes: some 200 MB


def cast_rays_numpy(
    scene: Scene, corner: NDArray[np.float32], columns: int, rows: int, group: int
) -> NDArray[np.int32]:
    """1 + the triangle that each ray (rows, columns) meets first, 0 for none.

    Args:
        scene: its triangles, texture coordinates and alpha.
        corner: (n, 3) the vertices as (x, y) [rays] and nearness [m].
        columns: rays in a row.
        rows: of rays.
        group: rays along each side of a pixel.
    """
    triangles = scene.triangles
    x, y = (corner[:, axis][triangles] for axis in (0, 1))
    left, right = (np.clip(f(x, axis=1), 0, columns).astype(int) for f in (np.min, np.max))
    upper, lower = (np.clip(f(y, axis=1), 0, rows).astype(int) for f in (np.min, np.max))
    wide, high = np.minimum(right, columns - 1) - left + 1, np.minimum(lower, rows - 1) - upper + 1
    count = np.maximum(wide, 0) * np.maximum(high, 0)
    near, hit = np.full(rows * columns, -np.inf, np.float32), np.zeros(rows * columns, np.int32)
    ends = np.cumsum(count)
    borders = np.searchsorted(ends, np.arange(_AT_ONCE, ends[-1] + _AT_ONCE, _AT_ONCE), side="right")
    for low, top in zip([0, *borders[:-1]], borders, strict=True):
        own = np.arange(low, top)
        t = np.repeat(own, count[own])
        within = np.arange(len(t)) - np.repeat(np.cumsum(count[own]) - count[own], count[own])
        row, column = upper[t] + within // wide[t], left[t] + within % wide[t]
        px = column + ((row % group) + 0.5) / group
        py = row + ((column % group) + 0.5) / group
        of = triangles[t]
        a, b, c = corner[of[:, 0]], corner[of[:, 1]], corner[of[:, 2]]
        b, c = b - a, c - a
        with np.errstate(divide="ignore", invalid="ignore"):
            over = 1.0 / (b[:, 0] * c[:, 1] - b[:, 1] * c[:, 0])
            wb = ((px - a[:, 0]) * c[:, 1] - (py - a[:, 1]) * c[:, 0]) * over
            wc = ((py - a[:, 1]) * b[:, 0] - (px - a[:, 0]) * b[:, 1]) * over
        inside = np.flatnonzero((wb >= 0) & (wc >= 0) & (wb + wc <= 1))
        t, of, wb, wc = t[inside], of[inside], wb[inside, None], wc[inside, None]
        uv = scene.uvs[of[:, 0]] * (1 - wb - wc) + scene.uvs[of[:, 1]] * wb + scene.uvs[of[:, 2]] * wc
        solid = np.flatnonzero((t < scene.wood_triangles) | (sample_alpha(scene.alpha, uv) >= scene.cutoff))
        keep = inside[solid]
        depth = (a[keep, 2] + wb[solid, 0] * b[keep, 2] + wc[solid, 0] * c[keep, 2]).astype(np.float32)
        ray, t = row[keep] * columns + column[keep], t[solid]
        order = np.lexsort((t, -depth, ray))
        first = order[np.diff(ray[order], prepend=-1) > 0]
        first = first[depth[first] > near[ray[first]]]
        near[ray[first]], hit[ray[first]] = depth[first], t[first] + 1
    return hit.reshape(rows, columns)
