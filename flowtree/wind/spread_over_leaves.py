"""Wind weights of the leaves' vertices."""

from __future__ import annotations

import numpy as np

from flowtree.geometry.frames import unit
from flowtree.model.foliage import Foliage
from flowtree.model.skeleton import Skeleton
from flowtree.model.wind import VertexWind, WindWeights
from flowtree.wind.place_on_segments import place_on_segments

# A plane wave that neighbouring leaves meet at different times; its length in lengths of the largest leaf.
_WAVE = unit(np.array([[0.62, 0.41, 0.67]]))[0] / 1.7


def spread_over_leaves(skeleton: Skeleton, weights: WindWeights, foliage: Foliage) -> VertexWind:
    """Gives every vertex of a leaf the values of the place where its stalk stands, and flutter.

    So a leaf moves with its twig as one piece and cannot come off; fluttering adds to that, none at the
    stalk's end, most at the tip, with each leaf's own phase.

    Args:
        skeleton: n nodes.
        weights: of its nodes.
        foliage: k leaves of m vertices.

    Returns: k * m vertices, leaf by leaf.

    Raises:
        InputError: leaves on nodes that the skeleton has not.
    """
    node = foliage.node
    share = place_on_segments(skeleton, node, foliage.position)[:, None]
    above = np.maximum(skeleton.parent[node], 0)
    extent = (1 - share) * weights.extent[above] + share * weights.extent[node]
    corner = np.linalg.norm(foliage.leaf.positions, axis=1)
    largest = float(corner.max(initial=0.0)) * float(foliage.scale.max(initial=0.0))
    flutter = foliage.scale[:, None] * corner / (largest or 1.0)
    # Rounding up to 1 would be the same place of the cycle, but out of range.
    phase = (foliage.position.astype(np.float64) @ _WAVE / (largest or 1.0)) % 1.0
    phase = np.minimum(phase, np.nextafter(np.float32(1), np.float32(0)))

    corners = len(corner)
    branch = np.concatenate([weights.phase[node], phase[:, None]], axis=1).astype(np.float32)
    return VertexWind(
        depth=np.repeat(weights.depth[node], corners),
        pivot=np.repeat(weights.pivot[node], corners, axis=0),
        extent=np.concatenate(
            [np.repeat(extent, corners, axis=0), np.minimum(flutter, 1.0).reshape(-1, 1)], axis=1
        ).astype(np.float32),
        phase=np.repeat(branch, corners, axis=0),
    )
