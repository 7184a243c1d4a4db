"""What of a mesh may move while its creases are rounded."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flowtree.geometry.quad_edges import pair_edges
from flowtree.meshing.branch_axes import Ints
from flowtree.meshing.build_tubes import ControlMesh


def free_edges(mesh: ControlMesh, kept: tuple[int, ...]) -> tuple[NDArray[np.bool_], Ints, Ints]:
    """Vertices (n,) that no quad of the kept kinds has, and the edges (e,) that lie between two other quads.

    Returns: which vertices may move; the corners from which each edge leaves, as `pair_edges` gives them.
    """
    still = np.isin(mesh.kind, kept)
    moves = np.ones(len(mesh.positions), np.bool_)
    moves[mesh.quads[still]] = False
    one, two = pair_edges(mesh.quads)
    counts = ~(still[one // 4] | still[two // 4])
    return moves, one[counts], two[counts]
