"""Lays folded quads anew, where descent can't turn them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import splu

from flowtree.geometry.quad_edges import edge_cosines
from flowtree.meshing.branch_axes import Floats, Ints
from flowtree.meshing.free_edges import FreeEdges
from flowtree.meshing.spread_creases import STEPS, spread_creases

Bools = NDArray[np.bool_]

_TURNS = 4  # in which pieces are cut anew, and descent may take twice as many steps as before
# Rings of quads around a crease that are laid anew, and whether as a plate or as a membrane.
_TRIALS = tuple((rings, plate) for rings in (1, 2, 3, 4, 6) for plate in (True, False))
_MARGIN = 14  # rings of quads around a crease that belong to its piece: more than spreading moves


def unfold_creases(positions: Floats, quads: Ints, edges: FreeEdges, *, limit: float) -> Floats:
    """Lays the quads around the creases that `spread_creases` leaves anew, and spreads what comes of it.

    Two quads that lie on each other turn by 180 degrees, where the cosine has no slope: descent goes nowhere
    from there. So the vertices around are put where a plate of least bend would have them that hangs on the
    quads farther out, or a membrane (each in the middle of its neighbours), of a few sizes in turn, and
    creases are spread from there. Every piece of the surface keeps the trial that left the fewest. Not in
    the paper.

    Args:
        positions: (n, 3) [m].
        quads: (m, 4).
        edges: what may move.
        limit: [degrees] between the normals of two quads.

    Returns: positions (n, 3) [m].
    """
    positions = positions.copy()
    for turn in range(_TURNS):
        part = _widened(quads, _creased(positions, quads, edges, limit), _MARGIN)
        if not part.any():
            break
        vertex, rows = np.unique(quads[part], return_inverse=True)
        moves = edges.moves.copy()
        moves[quads[~part]] = False
        number = np.cumsum(part) - 1
        within = part[edges.one // 4] & part[edges.two // 4]
        one, two = (4 * number[corner[within] // 4] + corner[within] % 4 for corner in (edges.one, edges.two))
        piece = FreeEdges(moves[vertex], one, two)
        positions[vertex] = _unfolded(positions[vertex], rows.reshape(-1, 4), piece, limit, STEPS << turn)
    return positions


def _unfolded(positions: Floats, quads: Ints, edges: FreeEdges, limit: float, steps: int) -> Floats:
    """Positions (n, 3) after all trials with the pieces around creases."""
    beside = coo_array((np.ones(3 * len(quads)), (quads[:, :3].ravel(), quads[:, 1:].ravel())))
    beside.resize(len(positions), len(positions))
    piece = connected_components(beside, directed=False)[1][quads[:, 0]]
    creased = _creased(positions, quads, edges, limit)
    for rings, plate in _TRIALS:
        if not creased.any():
            break
        free = np.zeros(len(positions), np.bool_)
        free[quads[_widened(quads, creased, rings - 1)]] = True
        laid = _laid(positions, quads, free & edges.moves, plate)
        laid = spread_creases(laid, quads, edges, limit=limit, steps=steps)
        still = _creased(laid, quads, edges, limit)
        better = (np.bincount(piece, still) < np.bincount(piece, creased))[piece]
        positions[quads[better]] = laid[quads[better]]
        creased = np.where(better, still, creased)
    return positions


def _creased(positions: Floats, quads: Ints, edges: FreeEdges, limit: float) -> Bools:
    """Quads (m,) that turn by more than the limit against another."""
    sharp = np.flatnonzero(edge_cosines(positions, quads, edges.one, edges.two) < np.cos(np.radians(limit)))
    creased = np.zeros(len(quads), np.bool_)
    creased[edges.one[sharp] // 4] = creased[edges.two[sharp] // 4] = True
    return creased


def _widened(quads: Ints, part: Bools, rings: int) -> Bools:
    """Some quads (m,) with so many rings of others around them."""
    near = np.zeros(int(quads.max()) + 1, np.bool_)
    for _ in range(rings if part.any() else 0):
        near[quads[part]] = True
        part = np.asarray(near[quads].any(axis=1), np.bool_)
    return part


def _laid(positions: Floats, quads: Ints, free: Bools, plate: bool) -> Floats:
    """Positions (n, 3) with the free vertices (n,) as a membrane, or a plate, that hangs on the others."""
    if not free.any():
        return positions
    count = len(positions)
    start, end = quads.ravel(), np.roll(quads, -1, axis=1).ravel()
    both = np.concatenate([start, end]), np.concatenate([end, start])
    beside = coo_array((np.ones(len(both[0])), both), shape=(count, count)).tocsr()
    start, end = beside.nonzero()
    share = 1.0 / np.bincount(start, minlength=count)
    # How far a vertex is from the middle of its neighbours; in a plate that counts beside the free ones, too.
    each = np.arange(count)
    rows, columns = np.concatenate([start, each]), np.concatenate([end, each])
    values = np.concatenate([share[start], np.full(count, -1.0)])
    offset = coo_array((values, (rows, columns)), shape=(count, count)).tocsr()
    counts = free.copy()
    if plate:
        counts[quads[free[quads].any(axis=1)]] = True
    offset = offset[np.flatnonzero(counts)]
    moved, fixed = (offset[:, np.flatnonzero(chosen)] for chosen in (free, ~free))
    pull = -moved.T @ (fixed @ positions[~free])
    positions = positions.copy()
    positions[free] = splu((moved.T @ moved).tocsc()).solve(pull)
    return positions
