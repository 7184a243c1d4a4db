"""Rounds creases that are left where branches crowd each other."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flowtree.geometry.quad_edges import edge_cosines
from flowtree.meshing.branch_axes import Floats, Ints
from flowtree.meshing.free_edges import FreeEdges

Bools = NDArray[np.bool_]

_STEP = 0.2  # of the way that a vertex goes at once
_STRIDE = 5  # rounds
_RINGS = 3  # of quads around a crease that may give way in these
_ALIKE = 1e-12  # of the mesh's extent; nearer neighbours would pull without bound


def relax_creases(positions: Floats, quads: Ints, edges: FreeEdges, *, limit: float, rounds: int) -> Floats:
    """Moves vertices until few edges turn by more than a limit.

    Each end of a crease goes to the straight line between its neighbours across the crease, the nearer one
    counting more (the curve-shortening flow of that section): a sharp crotch fills, a ridge sinks, and a tube
    does not become thinner, as it would by smoothing in all directions. What becomes a crease thereby gives
    way in the next round. Where two rows of a narrow crotch have come together that flow stands still: that
    is left to `spread_creases`. Not in the paper, which shows forks with room around them.

    Args:
        positions: (n, 3) [m].
        quads: (m, 4).
        edges: what may move.
        limit: [degrees] between the normals of two quads.
        rounds: at most; some creases between folded quads never go.

    Returns: positions (n, 3) [m].
    """
    positions, moves, one, two = positions.copy(), edges.moves, edges.one, edges.two
    cosine = float(np.cos(np.radians(limit)))
    tiny = _ALIKE * float(np.ptp(positions, axis=0).max())
    for turn in range(rounds):
        bend = edge_cosines(positions, quads, one, two)
        sharp = np.flatnonzero(bend < cosine)
        if not len(sharp):
            break
        here, there, bend = one[sharp], two[sharp], bend[sharp]
        corner = quads.ravel()
        ends = np.concatenate([corner[here], corner[_next(here, 1)]])
        # The second quad passes the edge the other way round.
        before = np.concatenate([corner[_next(here, 3)], corner[_next(here, 2)]])
        after = np.concatenate([corner[_next(there, 2)], corner[_next(there, 3)]])
        weight = np.tile(np.clip(1.0 - bend, 0.1, 2.0), 2)
        vertex, place = np.unique(ends, return_inverse=True)
        near, far = (
            np.maximum(np.linalg.norm(positions[other] - positions[ends], axis=1), tiny)
            for other in (before, after)
        )
        wanted = positions[before] + (near / (near + far))[:, None] * (positions[after] - positions[before])
        total = np.bincount(place, weight)
        target = np.stack([np.bincount(place, weight * column) for column in wanted.T], axis=1)
        if turn % _STRIDE == 0:
            # Few quads need to be looked at: those that creases reach before the next time.
            moves, part = _around(quads, moves, np.concatenate([here, there]) // 4)
            quads, row = quads[part], np.cumsum(part) - 1
            within = part[one // 4] & part[two // 4]
            one, two = (4 * row[edge[within] // 4] + edge[within] % 4 for edge in (one, two))
        free = moves[vertex]
        vertex, target = vertex[free], target[free] / total[free, None]
        positions[vertex] += _STEP * (target - positions[vertex])
    return positions


def _around(quads: Ints, moves: Bools, creased: Ints) -> tuple[Bools, Bools]:
    """Vertices (n,) near quads (k,) that may still move, and all quads (m,) that have one of them."""
    near = np.zeros(len(moves), np.bool_)
    near[quads[creased]] = True
    for _ in range(_RINGS):
        near[quads[near[quads].any(axis=1)]] = True
    near &= moves
    return near, np.asarray(near[quads].any(axis=1), np.bool_)


def _next(corner: Ints, steps: int) -> Ints:
    """The corner (e,) of the same quad so many steps on."""
    return np.asarray(corner - corner % 4 + (corner + steps) % 4, np.int64)
