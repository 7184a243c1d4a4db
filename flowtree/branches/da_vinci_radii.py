"""Da Vinci's rule (Particle Flows, section 8)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from flowtree import check
from flowtree.branches.order_branches import order_branches
from flowtree.geometry.parent_array import child_count, levels
from flowtree.model.skeleton import Skeleton
from flowtree.params import ThicknessParams


def da_vinci_radii(
    skeleton: Skeleton, *, trunk_radius: float | None = None, params: ThicknessParams = ThicknessParams()
) -> Skeleton:
    """Gives every node a radius [m]: ``r**2 = a * sum(r_i**2)`` over its children, tips in proportion to particles.

    Unlike the paper, which leaves the scale open, the trunk's width sets it: ``params.trunk_radius``, else the
    one measured in the photos, else a share of the height.

    Args:
        skeleton: the branches.
        trunk_radius: measured above the foot [m]; None where no photo shows the trunk.
        params: the constant and the trunk's radius.

    Returns: the skeleton with ``radius``, never smaller at a parent than at a child, and ``level`` by it.

    Raises:
        InputError: the skeleton has no segment.
    """
    check.require(
        len(skeleton.parent) > 1, "skeleton", "needs a segment", "a single node", "trace more particles"
    )
    area = np.maximum(skeleton.particles.astype(np.float64), 0.0)
    np.subtract.at(area, skeleton.parent[1:], skeleton.particles[1:])  # what sets off at each node itself
    children = child_count(skeleton.parent)
    area[children == 0] = np.maximum(area[children == 0], 1.0)
    total = area.copy()
    for nodes in reversed(levels(skeleton.parent)[1:]):
        above = skeleton.parent[nodes]
        np.add.at(total, above, total[nodes] * np.where(children[above] > 1, params.da_vinci, 1.0))
    height = float(np.ptp(skeleton.points[:, 1]))
    trunk = params.trunk_radius or trunk_radius or params.slenderness * height
    # Above the root's own forks: what carries the crown counts, not the node at the very foot.
    radius = np.sqrt(total / total[0]) * trunk
    radius = np.maximum(radius, min(params.thinnest * height, trunk))
    return replace(skeleton, radius=radius.astype(np.float32), level=order_branches(skeleton.parent, radius))
