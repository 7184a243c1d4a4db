"""Catmull-Clark subdivision of surfaces of quads."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


ROUND = 1.5 - np.sqrt(2.0)  # of a straight square tube the first step makes a regular octagon


def subdivide_quads(
    positions: Floats, quads: NDArray[np.integer[Any]], *, rounding: float = 0.0
) -> tuple[Floats, Ints, Ints]:
    """One step of Catmull and Clark's scheme (1978); a rim, where there is one, as a cubic B-spline.

    Of a square tube the scheme makes octagons whose corners turn by 53 and 37 degrees in turn. With rounding,
    so much of the weight of a vertex, or of an edge's ends, goes to the middles of the quads beside it
    (after Morin, Warren and Weimer, "A subdivision scheme for surfaces of revolution", 2001, but the same at
    every step): with `ROUND` they turn by 45.

    Args:
        positions: (n, d).
        quads: (m, 4); every edge belongs to one or two.
        rounding: weight that goes to the quads' middles, 0 to 0.25.

    Returns:
        positions: (n + e + m, d): the moved vertices, one new vertex an edge, one a quad.
        quads: (4 m, 4): quad f becomes rows 4 f to 4 f + 3; row 4 f + k is corner k, the vertex on the edge
            that leaves it, the quad's own vertex, and the vertex on the edge that arrives.
        edges: (e, 2) the ends of the edges, in the order of their vertices.
    """
    count, faces = len(positions), quads.astype(np.int64)
    start, end = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    key = np.minimum(start, end) * count + np.maximum(start, end)
    order = order_of(key)
    # In the sorted list the quads of an edge lie side by side.
    fresh = np.concatenate(([True], np.diff(key[order]) != 0))[: len(key)]
    first = np.flatnonzero(fresh)
    last = np.append(first[1:], len(key))[: len(first)] - 1
    edges = np.stack(np.divmod(key[order[first]], count), axis=1)
    edge_of = np.empty(len(key), np.int64)
    edge_of[order] = np.cumsum(fresh) - 1

    center = 0.25 * positions[faces].sum(axis=1)
    middle = 0.5 * (positions[edges[:, 0]] + positions[edges[:, 1]])
    rim = first == last
    beside = center[order[first] // 4] + center[order[last] // 4]
    on_edge = (0.5 - rounding) * middle + (0.25 + 0.5 * rounding) * beside
    on_edge[rim] = middle[rim]

    # Around a vertex of valence v: its quads' centres and its edges' middles weigh 1 / v each, (v - 2) / v is
    # its own. Summed over quads: the next corner's half edge stands for each edge once.
    valence = np.bincount(start, minlength=count).astype(np.float64)
    share = 1.0 / np.maximum(valence, 1.0)[:, None]
    around = np.repeat((1.0 + 4.0 * rounding) * center, 4, axis=0) + positions[end]
    total = np.stack([np.bincount(start, column, count) for column in around.T], axis=1)
    moved = total * share**2 + positions * (1.0 - (2.0 + 4.0 * rounding) * share)
    if rim.any():
        moved = _along_rims(positions, edges[rim], moved)

    face = np.arange(len(faces)) + count + len(edges)
    after = edge_of.reshape(-1, 4) + count
    before = np.roll(after, 1, axis=1)
    rows = np.stack([faces, after, np.repeat(face[:, None], 4, axis=1), before], axis=2)
    return np.concatenate([moved, on_edge, center]), rows.reshape(-1, 4), edges


def order_of(key: Ints) -> Ints:
    """Where the keys (n,), none negative, stand when sorted, equal ones as they come."""
    bits = len(key).bit_length()
    if int(key.max(initial=0)).bit_length() + bits > 63:
        return np.argsort(key, kind="stable")
    # Numbers are sorted many times faster than places are: so each carries its place.
    return np.asarray(np.sort((key << bits) + np.arange(len(key))) & ((1 << bits) - 1), np.int64)


def _along_rims(positions: Floats, rim: Ints, moved: Floats) -> Floats:
    """The moved vertices (n, d), those on rims (r, 2) placed by the rim alone; where rims meet they stay."""
    here, there = rim.ravel(), rim[:, ::-1].ravel()
    number = np.bincount(here, minlength=len(positions))
    beside = np.stack([np.bincount(here, column, len(positions)) for column in positions[there].T], axis=1)
    on_rim = np.where((number == 2)[:, None], 0.75 * positions + 0.125 * beside, positions)
    return np.where((number > 0)[:, None], on_rim, moved)


def subdivide_corners(
    quads: NDArray[np.integer[Any]], values: NDArray[Any], *, rounding: float = 0.0
) -> Floats:
    """Values at the quads' corners (m, 4, d) for the quads that they become (4 m, 4, d).

    They are smoothed as positions are, with rims where values differ across an edge: so a texture follows
    where subdivision moves a surface.
    """
    place, corner = split_corners(quads, values)
    flat = np.zeros((len(place), values.shape[2]))  # a vertex may have no quad any more
    flat[corner] = values
    finer, rows, _ = subdivide_quads(flat, corner, rounding=rounding)
    return np.asarray(finer[rows], np.float64)


def split_corners(quads: NDArray[np.integer[Any]], values: NDArray[Any]) -> tuple[Ints, Ints]:
    """Vertices that have one value each: the vertex (k,) that each comes from, and the corners' (m, 4).

    Args:
        quads: (m, 4).
        values: (m, 4, d) of the corners; those that share a vertex and are equal to the last bit are one.
    """
    flat, rows = quads.ravel().astype(np.int64), values.reshape(-1, values.shape[2])
    count = int(flat.max()) + 1
    # One corner stands for its vertex; only the few that differ from it, at seams, need sorting.
    example = np.zeros(count, np.int64)
    example[flat[::-1]] = np.arange(len(flat))[::-1]
    differs = np.flatnonzero((rows != rows[example[flat]]).any(axis=1))
    order = differs[np.lexsort((*rows[differs].T, flat[differs]))]
    other = (flat[order][1:] != flat[order][:-1]) | (rows[order][1:] != rows[order][:-1]).any(axis=1)
    fresh = np.concatenate(([True], other))[: len(order)]
    corner = flat.copy()
    corner[order] = count + np.cumsum(fresh) - 1
    return np.concatenate([np.arange(count), flat[order[fresh]]]), corner.reshape(-1, 4)
