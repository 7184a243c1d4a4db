"""Catmull-Clark subdivision of closed surfaces of quads."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def subdivide_quads(positions: Floats, quads: NDArray[np.integer[Any]]) -> tuple[Floats, Ints, Ints]:
    """One step of Catmull and Clark's scheme (1978), where every edge belongs to two quads.

    Args:
        positions: (n, 3).
        quads: (m, 4).

    Returns:
        positions: (n + e + m, 3): the moved vertices, one new vertex an edge, one a quad.
        quads: (4 m, 4): quad f becomes rows 4 f to 4 f + 3; row 4 f + k is corner k, the vertex on the edge
            that leaves it, the quad's own vertex, and the vertex on the edge that arrives.
        edges: (e, 2) the ends of the edges, in the order of their vertices.
    """
    count, faces = len(positions), quads.astype(np.int64)
    start, end = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    key = np.minimum(start, end) * count + np.maximum(start, end)
    order = np.argsort(key, kind="stable")
    # Every edge is passed twice: in the sorted list its two quads lie side by side.
    edges = np.stack(np.divmod(key[order[::2]], count), axis=1)
    edge_of = np.empty(len(key), np.int64)
    edge_of[order] = np.arange(len(key)) // 2

    corner = positions[faces]
    center = 0.25 * corner.sum(axis=1)
    either = order.reshape(-1, 2) // 4
    middle = 0.5 * (positions[edges[:, 0]] + positions[edges[:, 1]])
    on_edge = 0.5 * middle + 0.25 * (center[either[:, 0]] + center[either[:, 1]])

    # Around a vertex of valence v: its quads' centres and its edges' middles weigh 1 / v each, (v - 2) / v is
    # its own. Summed over quads: the next corner's half edge stands for each edge once.
    valence = np.bincount(start, minlength=count).astype(np.float64)
    across = positions[end]
    around = np.repeat(center, 4, axis=0) + across
    total = np.stack([np.bincount(start, around[:, k], count) for k in range(3)], axis=1)
    share = 1.0 / np.maximum(valence, 1.0)[:, None]
    moved = total * share**2 + positions * (1.0 - 2.0 * share)

    face = np.arange(len(faces)) + count + len(edges)
    after = edge_of.reshape(-1, 4) + count
    before = np.roll(after, 1, axis=1)
    rows = np.stack([faces, after, np.repeat(face[:, None], 4, axis=1), before], axis=2)
    return np.concatenate([moved, on_edge, center]), rows.reshape(-1, 4), edges


def subdivide_corners(values: NDArray[Any]) -> NDArray[Any]:
    """Values at the quads' corners (m, 4, ...) for the quads that they become (4 m, 4, ...), bilinear."""
    after = 0.5 * (values + np.roll(values, -1, axis=1))
    center = np.repeat(values.mean(axis=1, keepdims=True), 4, axis=1)
    parts = np.stack([values, after, center, np.roll(after, 1, axis=1)], axis=2)
    return parts.reshape(-1, *values.shape[1:])
