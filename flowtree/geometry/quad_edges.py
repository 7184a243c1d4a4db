"""Edges of closed surfaces of quads, and how far the surface turns at them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flowtree.geometry.catmull_clark import order_of

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def pair_edges(quads: Ints) -> tuple[Ints, Ints]:
    """Corners (e,) from which each edge leaves, in its one quad and in its other: k of quad f is 4 f + k.

    Args:
        quads: (m, 4); an edge that only one of them has, at the rim of a piece, is left out.
    """
    start, end = quads.ravel(), np.roll(quads, -1, axis=1).ravel()
    key = np.minimum(start, end) * (int(start.max(initial=0)) + 1) + np.maximum(start, end)
    order = order_of(key)
    first = np.flatnonzero(key[order[1:]] == key[order[:-1]])
    return order[first], order[first + 1]


def edge_cosines(positions: Floats, quads: Ints, one: Ints, two: Ints) -> Floats:
    """(e,), between the normals of the two quads of edges that leave from corners one (e,) and two (e,)."""
    normal = quad_normals(positions, quads)
    return np.asarray(np.einsum("ed,ed->e", normal[one // 4], normal[two // 4]))


def quad_normals(positions: Floats, quads: Ints) -> Floats:
    """(m, 3), across both diagonals; unit, or 0 where a quad is a line."""
    first, second = (positions[quads[:, k + 2]] - positions[quads[:, k]] for k in (0, 1))
    across = np.cross(first, second)
    length = np.linalg.norm(across, axis=1, keepdims=True)
    return np.asarray(np.divide(across, length, out=np.zeros_like(across), where=length > 0.0))
