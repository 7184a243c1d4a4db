"""What of a mesh may move while its creases are rounded."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flowtree.geometry.quad_edges import pair_edges
from flowtree.meshing.branch_axes import Ints
from flowtree.meshing.build_tubes import ControlMesh


@dataclass(frozen=True)
class FreeEdges:
    """Vertices that may move, and the edges between quads that may turn against each other.

    Attributes:
        moves: (n,), which vertices.
        one: (e,) corners from which the edges leave in their one quad, as `pair_edges` gives them.
        two: (e,), the same in their other quad.
    """

    moves: NDArray[np.bool_]
    one: Ints
    two: Ints


def free_edges(mesh: ControlMesh, kept: tuple[int, ...]) -> FreeEdges:
    """Vertices that no quad of the kept kinds has, and the edges that lie between two other quads."""
    still = np.isin(mesh.kind, kept)
    moves = np.ones(len(mesh.positions), np.bool_)
    moves[mesh.quads[still]] = False
    one, two = pair_edges(mesh.quads)
    counts = ~(still[one // 4] | still[two // 4])
    return FreeEdges(moves, one[counts], two[counts])
