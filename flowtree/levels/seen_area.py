"""How much of the sky a leaf hides."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flowtree.model.mesh import Material, TreeMesh

_GRID = 64  # points along a triangle's side at which the alpha is looked up
_CELL = 1.0 / 40.0  # of the leaf's length: of the pictures in which it is seen
_DIRECTIONS = 16


def seen_area(leaf: TreeMesh, material: Material) -> float:
    """The mean area [m²] of what is seen of a leaf 1 m long, over all directions; s² times that at length s.

    What hides itself, as crossed planes do, counts once. Points of the surface that pass the alpha test are
    projected along directions spread over half the sphere, and the cells counted that they fall into: too
    many by what is seen of cells at the outline, but the same for two shapes of one leaf.
    """
    a, b, c = (leaf.positions[leaf.triangles[:, k]].astype(np.float64) for k in range(3))
    step = (np.arange(_GRID) + 1.0 / 3.0) / _GRID
    u, v = (part.ravel() for part in np.meshgrid(step, step))
    u, v = u[u + v < 1.0], v[u + v < 1.0]
    points = a[:, None] + u[:, None] * (b - a)[:, None] + v[:, None] * (c - a)[:, None]
    picture = material.base_color
    if picture.shape[2] == 4 and material.alpha_cutoff is not None:
        p, q, r = (leaf.uvs[leaf.triangles[:, k]].astype(np.float64) for k in range(3))
        uv = p[:, None] + u[:, None] * (q - p)[:, None] + v[:, None] * (r - p)[:, None]
        rows, columns = picture.shape[:2]
        column = np.floor(uv[:, :, 0] * columns).astype(int) % columns
        row = np.floor(uv[:, :, 1] * rows).astype(int) % rows
        points = points[picture[row, column, 3] >= 255.0 * material.alpha_cutoff]
    flat = points.reshape(-1, 3)
    if not len(flat):
        return 0.0
    return float(np.mean([_shadow(flat, toward) for toward in _directions()]))


def _directions() -> NDArray[np.float64]:
    """Unit vectors (n, 3) spread over the half sphere by the golden angle."""
    up = (np.arange(_DIRECTIONS) + 0.5) / _DIRECTIONS
    turn = np.pi * (3.0 - 5.0**0.5) * np.arange(_DIRECTIONS)
    flat = np.sqrt(1.0 - up * up)
    return np.stack([flat * np.cos(turn), up, flat * np.sin(turn)], axis=1)


def _shadow(points: NDArray[np.float64], toward: NDArray[np.float64]) -> float:
    right = np.cross([0.0, 1.0, 0.0], toward)
    right /= np.linalg.norm(right)
    up = np.cross(toward, right)
    # Written out, not left to a matrix product: its rounding depends on how many cores share the work.
    cell = [np.floor((points * axis).sum(axis=1) / _CELL).astype(np.int64) for axis in (right, up)]
    return float(len(np.unique(cell[0] * (1 << 32) + cell[1]))) * _CELL**2
