"""How much of the sky and of the ground each place in a crown sees."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flowtree.render.assemble_scene import Scene

_CELLS = 48  # along the scene's longest side
_DIRECTIONS = 26
_FACING = 0.5  # mean share of a leaf's area that a ray meets, over all its turns
# Leaves pass and scatter light on: the crown is brighter inside than black leaves would leave it.
_OPACITY = 0.55


def gather_sky_light(scene: Scene) -> NDArray[np.float32]:
    """Follows light from all directions through a grid of the scene's density (emission-absorption).

    The light that comes to a vertex is kept as its mean over the sphere and its mean times direction, so that
    a surface with normal n receives ``mean + 2 * dot(vector, n)`` of what an open sky of radiance 1 gives.
    A leaf has one place, its first vertex's.

    Returns: (2, 4, n) float32 for the scene's n vertices: from the sky, from the ground; the mean and the
        vector's coordinates.
    """
    if not len(scene.triangles):
        return np.zeros((2, 4, scene.positions.shape[1]), np.float32)
    low, cell, density = _density_grid(scene)
    light = np.zeros((2, 4, *density.shape), np.float32)
    for toward in _directions():
        seen = _transmittance(density, toward, cell)
        side = 0 if toward[1] > 0 else 1
        for part, factor in enumerate((1.0, *toward)):
            light[side, part] += np.float32(factor / _DIRECTIONS) * seen
    at = (scene.positions - low[:, None]) / np.float32(cell) - np.float32(0.5)
    return _interpolate(light, at)


def _directions() -> NDArray[np.float64]:
    """Unit vectors spread evenly over the sphere, by the golden angle; as many up as down."""
    index = np.arange(_DIRECTIONS) + 0.5
    up = 1.0 - 2.0 * index / _DIRECTIONS
    turn = np.pi * (1.0 + 5.0**0.5) * index
    flat = np.sqrt(1.0 - up * up)
    return np.stack([flat * np.cos(turn), up, flat * np.sin(turn)], axis=1)


def _density_grid(scene: Scene) -> tuple[NDArray[np.float32], float, NDArray[np.float32]]:
    """The grid's corner [m], its cell [m] and the extinction of light [1/m] in each cell."""
    corners = scene.positions[:, scene.triangles]
    middle = corners.mean(axis=2)
    b, c = corners[:, :, 1] - corners[:, :, 0], corners[:, :, 2] - corners[:, :, 0]
    cross = np.stack([b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]])
    area = 0.5 * np.sqrt((cross * cross).sum(axis=0)).astype(np.float64)
    area[: scene.wood_triangles] *= 0.5  # wood shows light only one of its sides
    area[scene.wood_triangles :] *= float((scene.alpha >= scene.cutoff).mean())
    low, high = middle.min(axis=1), middle.max(axis=1)
    cell = max(float((high - low).max()) / _CELLS, 1e-6)
    low = low - np.float32(cell)
    shape = tuple(int(n) for n in np.ceil((high - low) / cell).astype(int) + 1)
    place = np.floor((middle - low[:, None]) / np.float32(cell)).astype(np.int64)
    total = np.bincount(np.ravel_multi_index(tuple(place), shape), area, minlength=int(np.prod(shape)))
    return low, cell, (_OPACITY * _FACING * total.reshape(shape) / cell**3).astype(np.float32)


def _transmittance(
    density: NDArray[np.float32], toward: NDArray[np.float64], cell: float
) -> NDArray[np.float32]:
    """The share of light from a direction that reaches each cell's middle.

    Slices across the direction's longest axis are passed one after the other; between two of them the optical
    depth is moved sideways, by bilinear weights.
    """
    axis = int(np.argmax(np.abs(toward)))
    order = [axis, *(k for k in range(3) if k != axis)]
    step = toward[order] / abs(toward[axis])
    turned = density.transpose(order)
    turned = turned[::-1] if step[0] > 0 else turned
    length = np.float32(cell * np.linalg.norm(step))
    depth = np.zeros_like(turned)
    for k in range(1, len(turned)):
        # Half of this cell and half of the last one lie between their middles, but nothing shades itself.
        depth[k] = _moved(depth[k - 1] + length * turned[k - 1], -step[1], -step[2])
    seen = np.exp(-depth)
    seen = seen[::-1] if step[0] > 0 else seen
    return seen.transpose(np.argsort(order))


def _moved(plane: NDArray[np.float32], rows: float, columns: float) -> NDArray[np.float32]:
    """The plane moved by at most one cell each way; what comes in from outside is 0."""
    framed = np.pad(plane, 1)
    for axis, by in ((0, rows), (1, columns)):
        share = np.float32(abs(by))
        framed = (1 - share) * framed + share * np.roll(framed, 1 if by > 0 else -1, axis=axis)
    return framed[1:-1, 1:-1]


def _interpolate(light: NDArray[np.float32], at: NDArray[np.float32]) -> NDArray[np.float32]:
    """Trilinear values (2, 4, n) of the grids at places (3, n) in cells; the border goes on outside."""
    shape = light.shape[2:]
    values = np.ascontiguousarray(light.reshape(8, -1).T)
    place = [np.clip(at[k], 0, shape[k] - 1.001) for k in range(3)]
    lower = [part.astype(np.int64) for part in place]
    share = [part - whole for part, whole in zip(place, lower, strict=True)]
    found = np.zeros((at.shape[1], 8), np.float32)
    for corner in np.ndindex(2, 2, 2):
        index = np.ravel_multi_index(tuple(n + k for n, k in zip(lower, corner, strict=True)), shape)
        weight = np.prod([s if k else 1 - s for s, k in zip(share, corner, strict=True)], axis=0)
        found += weight.astype(np.float32)[:, None] * values[index]
    return found.T.reshape(2, 4, -1)
