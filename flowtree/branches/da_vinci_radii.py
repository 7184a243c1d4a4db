"""Da Vinci's rule (Particle Flows, section 8)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from flowtree import check
from flowtree.branches.order_branches import order_branches
from flowtree.geometry.parent_array import child_count, levels
from flowtree.model.skeleton import Skeleton
from flowtree.params import ThicknessParams

_DA_VINCI = 2.0  # areas add up


def da_vinci_radii(
    skeleton: Skeleton,
    *,
    trunk_radius: float | None = None,
    bounds: NDArray[np.float64] | None = None,
    params: ThicknessParams = ThicknessParams(),
) -> Skeleton:
    """Gives every node a radius [m]: ``r**e = a * sum(r_i**e)`` over its children, with e = 2.

    Unlike the paper, which leaves the scale open, the trunk's width sets it: ``params.trunk_radius``, else
    the one measured in the photos, else a share of the height. ``params.exponent`` may replace the 2.

    Between forks the rule leaves a stem as thick as it was; real ones taper, by ``params.taper`` from root
    to tip. Where ``bounds`` leave the rule no choice they count, and what grows from there is as much thinner
    as the rule's branch is thinner than the rule's limb.

    Args:
        skeleton: the branches.
        trunk_radius: measured above the foot [m]; None where no photo shows the trunk.
        bounds: (n, 2) least and most radius of each node [m], as far as it was measured; None for none. A
            node is never thicker than its parent, whatever they say.
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
    radius = (total / total[0]) ** (1.0 / (params.exponent or _DA_VINCI)) * trunk
    radius *= 1.0 - params.taper * _way_share(skeleton)
    if bounds is not None:
        radius = _keep_within(skeleton.parent, radius, bounds)
    # Rounded before the levels are found by them: what is then as thick as another was a little thinner.
    kept = np.maximum(radius, min(params.thinnest * height, trunk)).astype(np.float32)
    return replace(skeleton, radius=kept, level=order_branches(skeleton.parent, kept))


def _keep_within(
    parent: NDArray[np.int32], radius: NDArray[np.float64], bounds: NDArray[np.float64]
) -> NDArray[np.float64]:
    """The rule's radii within their bounds, scaled beyond them; never growing toward a tip."""
    made = radius.copy()
    for nodes in levels(parent)[1:]:
        below = made[parent[nodes]]
        by_rule = below * radius[nodes] / np.maximum(radius[parent[nodes]], 1e-12)
        made[nodes] = np.minimum(np.clip(by_rule, bounds[nodes, 0], bounds[nodes, 1]), below)
    return made


def _way_share(skeleton: Skeleton) -> NDArray[np.float64]:
    """How far each node is on the way from the root to the farthest tip behind it: 0 at first, 1 at tips."""
    parent = skeleton.parent
    segment = np.linalg.norm(skeleton.points - skeleton.points[np.maximum(parent, 0)], axis=1).astype(
        np.float64
    )
    come, ahead = np.zeros(len(parent)), np.zeros(len(parent))
    walk = levels(parent)[1:]
    for nodes in walk:
        come[nodes] = come[parent[nodes]] + segment[nodes]
    for nodes in reversed(walk):
        np.maximum.at(ahead, parent[nodes], ahead[nodes] + segment[nodes])
    return np.asarray(come / np.maximum(come + ahead, 1e-12))
