"""The float64 twin of `flowtree.kernels.fit_sights`: structs of NumPy arrays."""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flowtree.kernels.reference.flow_fields import seen_larger

_Array = NDArray[Any]

FARTHEST = 20.0


def _interpolate(values: _Array, place: _Array) -> float:
    """Multilinear value between the centres of cells; 0 beyond them."""
    low = np.floor(place).astype(int)
    if (low < 0).any() or (low >= np.array(values.shape) - 1).any():
        return 0.0
    share = place - low
    corners = product((0, 1), repeat=len(low))
    return float(sum(np.prod(np.where(k, share, 1.0 - share)) * values[tuple(low + k)] for k in corners))


def look_up(values: _Array, view: int, u: float, v: float) -> float:
    """Bilinear value of a picture (columns, rows) between its cells' centres; 0 beyond it."""
    return _interpolate(values[view], np.array([u, v]))


def density_at(density: _Array, place: _Array) -> float:
    """Trilinear value between the voxels' centres, ``place`` counted in voxels; 0 beyond them."""
    return _interpolate(density, place)


def picture_place(views: Any, view: int, at: _Array) -> _Array:
    """Where a picture shows a place of the world, counted in cells' centres."""
    larger = seen_larger(views.toward[view] * views.closeness[view], at)
    height = views.eye[view] + (at[1] - views.eye[view]) * larger
    across = views.right[view] @ at * larger
    return np.array([(across - views.left) / views.cell - 0.5, max(height / views.cell - 0.5, 0.0)])


def sum_sights(
    first: int, views: Any, wanted: _Array, density: _Array, steps: int, depth_out: _Array
) -> None:
    """Sums the densities along the lines of sight through the pictures' cells; an index for each of them."""
    for i in range(first, wanted.size):
        view, column, row = np.unravel_index(i, wanted.shape)
        depth_out[view, column, row] = 0.0
        if wanted[view, column, row] <= 0.0:
            continue
        eye = np.array([0.0, views.eye[view], 0.0])
        across = views.left + (column + 0.5) * views.cell
        plane = views.right[view] * across + np.array([0.0, (row + 0.5) * views.cell, 0.0])
        for step in range(-steps, steps):
            depth = (step + 0.5) * views.cell
            at = eye + (plane - eye) * (1.0 - depth * views.closeness[view]) + depth * views.toward[view]
            depth_out[view, column, row] += density_at(density, (at - views.corner) / views.cell - 0.5)
        along = views.toward[view] - (plane - eye) * views.closeness[view]
        depth_out[view, column, row] *= np.linalg.norm(along)


def _centres(views: Any, density: _Array, i: int) -> Any:
    x, y = divmod(i, density.shape[1])
    for z in range(density.shape[2]):
        yield (x, y, z), views.corner + (np.array([x, y, z]) + 0.5) * views.cell


def scale_sights(first: int, views: Any, log_ratio: _Array, power: float, density_out: _Array) -> None:
    """Scales densities by what the views ask for where they see them; an index for each row along z."""
    for i in range(first, density_out.shape[0] * density_out.shape[1]):
        for voxel, at in _centres(views, density_out, i):
            seen = (picture_place(views, view, at) for view in range(len(log_ratio)))
            total = sum(look_up(log_ratio, view, *place) for view, place in enumerate(seen))
            density_out[voxel] *= np.exp(np.clip(power * total, -FARTHEST, FARTHEST))


def carve_sights(first: int, views: Any, depth: _Array, least: float, density_out: _Array) -> None:
    """Empties the voxels of which a view shows too little; an index for each row along z."""
    for i in range(first, density_out.shape[0] * density_out.shape[1]):
        for voxel, at in _centres(views, density_out, i):
            seen = (picture_place(views, view, at) for view in range(len(depth)))
            if any(look_up(depth, view, *place) < least for view, place in enumerate(seen)):
                density_out[voxel] = 0.0
