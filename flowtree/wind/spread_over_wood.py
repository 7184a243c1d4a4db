"""Wind weights of the wood's vertices."""

from __future__ import annotations

import numpy as np

from flowtree import check
from flowtree.model.mesh import TreeMesh
from flowtree.model.skeleton import Skeleton
from flowtree.model.wind import VertexWind, WindWeights
from flowtree.wind.place_on_segments import place_on_segments


def spread_over_wood(skeleton: Skeleton, weights: WindWeights, wood: TreeMesh) -> VertexWind:
    """Gives the wood's vertices the values at the nearest place of the segments that carry them.

    Args:
        skeleton: n nodes.
        weights: of its nodes.
        wood: v vertices that know their nodes.

    Returns: v vertices; they do not flutter.

    Raises:
        InputError: the mesh does not know its nodes, or they are not the skeleton's.
    """
    if wood.node is None:
        check.fail("wood", "must know the node of each vertex", "none", "build it by a stage that sets them")
    share = place_on_segments(skeleton, wood.node, wood.positions)[:, None]
    above = np.maximum(skeleton.parent[wood.node], 0)
    extent = (1 - share) * weights.extent[above] + share * weights.extent[wood.node]
    return VertexWind(
        depth=weights.depth[wood.node],
        pivot=weights.pivot[wood.node],
        extent=np.pad(extent, ((0, 0), (0, 1))),
        phase=np.pad(weights.phase[wood.node], ((0, 0), (0, 1))),
    )
