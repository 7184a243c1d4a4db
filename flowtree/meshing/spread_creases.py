"""Spreads the last creases over the quads around them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flowtree.geometry.catmull_clark import order_of
from flowtree.geometry.quad_edges import edge_cosines, quad_normals
from flowtree.meshing.branch_axes import Floats, Ints
from flowtree.meshing.free_edges import FreeEdges

Bools = NDArray[np.bool_]

_SPARE = 2.5  # [degrees] that descent aims below the limit
STEPS = 80  # of a spell of descent
_SPELLS = 8  # each looks at one ring of quads more
_RINGS = 2  # of quads around a crease that may give way in the first spell
_RATE, _MOMENTUM = 0.02, 0.8
_FURTHEST = 0.05  # of the edges' length that a vertex goes in a step
_THINNEST = 1e-9  # area of a quad by its diagonals' squares
_LEAST, _MOST = 0.2, 0.5  # weights of a crease just beyond what is aimed at, and of the sharpest


def spread_creases(
    positions: Floats, quads: Ints, edges: FreeEdges, *, limit: float, steps: int = STEPS
) -> Floats:
    """Moves vertices around creases by gradient descent until no edge turns by more than a limit.

    What is left by `relax_creases` lies where thin branches crowd each other and quads are folded: there no
    place is right for one vertex alone. Here all vertices of a neighbourhood move down the slope of the sum,
    over its creases, of how far the cosine between the two quads' normals lies below the limit's; what
    becomes a crease thereby counts from the next step on, until all turn a little. The vertices' connections
    stay, so the surface stays closed. Folds of two quads on each other are left to `unfold_creases`. Not in
    the paper.

    Args:
        positions: (n, 3) [m].
        quads: (m, 4).
        edges: what may move.
        limit: [degrees] between the normals of two quads.
        steps: of each spell of descent, at most.

    Returns: positions (n, 3) [m].
    """
    positions, moves = positions.copy(), edges.moves
    one, two = edges.one // 4, edges.two // 4
    sharp = np.flatnonzero(edge_cosines(positions, quads, edges.one, edges.two) < np.cos(np.radians(limit)))
    if not len(sharp):
        return positions
    beside = _Lists(np.concatenate([one, two]), np.tile(np.arange(len(one)), 2), len(quads))
    around = _Lists(quads.ravel(), np.arange(quads.size) // 4, len(positions))
    for rings in range(_RINGS, _RINGS + _SPELLS):
        near = np.unique(quads[np.concatenate([one[sharp], two[sharp]])])
        for _ in range(rings - 1):
            near = np.unique(quads[around.of(near)])
        near = near[moves[near]]
        # Quads that move and those beside them: no other edge can become a crease.
        looked_at = beside.of(around.of(near))
        part = np.unique(np.concatenate([one[looked_at], two[looked_at]]))
        vertex, piece = np.unique(quads[part], return_inverse=True)
        sides = np.searchsorted(part, one[looked_at]), np.searchsorted(part, two[looked_at])
        free = np.isin(vertex, near)
        positions[vertex] = _descend(positions[vertex], piece.reshape(-1, 4), sides, free, limit, steps)
        here, there = one[looked_at], two[looked_at]
        sharp = looked_at[_cosines(positions, quads, here, there) < np.cos(np.radians(limit))]
        if not len(sharp):
            break
    return positions


class _Lists:
    """For each of so many rows the values that belong to it."""

    def __init__(self, row: Ints, value: Ints, count: int) -> None:
        self._value = value[order_of(row)]
        self._start = np.concatenate([[0], np.cumsum(np.bincount(row, minlength=count))])

    def of(self, rows: Ints) -> Ints:
        """The values of rows, each once, growing."""
        size = self._start[rows + 1] - self._start[rows]
        first = np.repeat(self._start[rows] - np.cumsum(size) + size, size)
        return np.unique(self._value[first + np.arange(len(first))])


def _cosines(positions: Floats, quads: Ints, one: Ints, two: Ints) -> Floats:
    """(e,), between the normals of quads (e,)."""
    part, place = np.unique(np.concatenate([one, two]), return_inverse=True)
    normal = quad_normals(positions, quads[part])
    return np.asarray(np.einsum("ed,ed->e", normal[place[: len(one)]], normal[place[len(one) :]]))


def _descend(
    positions: Floats, quads: Ints, edges: tuple[Ints, Ints], free: Bools, limit: float, steps: int
) -> Floats:
    """Positions (n, 3) of a piece of the surface after a spell downhill; edges (e,) by their quads."""
    one, two = edges
    wanted = np.cos(np.radians(limit - _SPARE))
    corner, count = quads.ravel(), len(positions)
    length = np.linalg.norm(positions[corner] - positions[np.roll(quads, -1, axis=1).ravel()], axis=1)
    # Harmonic means: quads along thin branches are many times longer than wide.
    size = np.bincount(corner, minlength=count) / np.bincount(corner, 1.0 / np.maximum(length, 1e-300), count)
    size[~free] = 0.0
    place, speed = positions.T.copy(), np.zeros((3, count))
    for _ in range(steps):
        first, second = (place[:, quads[:, k + 2]] - place[:, quads[:, k]] for k in (0, 1))
        across = _cross(first, second)
        # Of a quad that is a line no slope is without bound.
        least = _THINNEST * (_dot(first, first) + _dot(second, second)) + 1e-300
        extent = np.maximum(np.sqrt(_dot(across, across)), least)
        normal = across / extent
        beyond = wanted - _dot(normal[:, one], normal[:, two])
        sharp = np.flatnonzero(beyond > 0.0)
        if not len(sharp):
            break
        here, there = one[sharp], two[sharp]
        bent, row = np.unique(np.concatenate([here, there]), return_inverse=True)
        weight = np.tile(np.minimum(beyond[sharp] + _LEAST, _MOST), 2)
        # Down the slope of the cosine, from normals to diagonals to corners.
        turn = _summed(row, weight * normal[:, np.concatenate([there, here])], len(bent))
        turn -= _dot(turn, normal[:, bent]) * normal[:, bent]
        turn /= extent[bent]
        pulls = _cross(second[:, bent], turn), _cross(turn, first[:, bent])
        moved, at = np.unique(quads[bent].T, return_inverse=True)
        pull = _summed(at.ravel(), np.concatenate([-pulls[0], -pulls[1], *pulls], axis=1), len(moved))
        speed *= _MOMENTUM
        speed[:, moved] += _RATE * np.square(size[moved]) * pull
        far = np.sqrt(_dot(speed, speed)) / np.maximum(_FURTHEST * size, 1e-300)
        speed /= np.maximum(far, 1.0)
        place += speed
    return place.T


def _cross(one: Floats, two: Floats) -> Floats:
    """(3, n), of vectors as columns: several times as fast as as rows."""
    (a, b, c), (d, e, f) = one, two
    return np.stack([b * f - c * e, c * d - a * f, a * e - b * d])


def _dot(one: Floats, two: Floats) -> Floats:
    return np.asarray(one[0] * two[0] + one[1] * two[1] + one[2] * two[2])


def _summed(rows: Ints, values: Floats, count: int) -> Floats:
    """Sums (3, count) of values (3, n) by their rows."""
    return np.stack([np.bincount(rows, column, count) for column in values])
