"""How far each part of a tree bends in the wind, and around which place."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flowtree import check
from flowtree.geometry.frames import unit
from flowtree.geometry.parent_array import levels
from flowtree.model.skeleton import Skeleton
from flowtree.model.wind import WindWeights

_LIMB, _FINE = 1, 2
_STIFFNESS = 2.0 / 3.0  # exponent of elastic similarity
_THINNEST = 0.02  # of the foot's radius: thinner twigs bend as this one
# What runs across the arm to its pivot is stretched by arm * turn / length: no segment's extent grows by more
# than this share of its length over the arm.
_STEEPEST = 0.25
# Lengths of the waves [tree heights] that spread the phases of limbs and finer branches, and how far along
# its branch each phase is read: branches that leave the stem at one height swing apart.
_WAVES = (0.23, 0.11)
_READ_AT = 0.15


def weigh_wind(skeleton: Skeleton, *, height: float, seed: int = 0) -> WindWeights:
    """Weighs every node for three tiers that swing one on the other: stem, limbs, all finer branches.

    Branches of all sizes bend alike under their own load when their length goes with radius**(2/3) (elastic
    similarity; McMahon 1973, "Size and shape in biology"). So a segment bends by its length over
    ``height * (radius / foot's radius)**(2/3)``, b, and the extent grows by ``(1 - extent) * (1 - exp(-b))``;
    but slower far from the pivot, where turning by different angles would stretch the wood. Nothing is
    relative to other nodes: a thinned copy of the skeleton gets about the same values where it kept its
    course, so that levels of detail swing as one.

    Phases are those of plane waves through the tree in a direction of chance: branches near each other follow
    one another as in a gust, and a small move of a branch moves its phase little.

    Args:
        skeleton: world frame [m]; its branching order says what is stem, limb and finer branch.
        height: of the tree [m].
        seed: turns the waves.

    Returns: see `WindWeights`; extents are continuous along the skeleton, also across forks.

    Raises:
        InputError: a height that is not positive.
    """
    positive = np.isfinite(height) and height > 0
    check.require(bool(positive), "height", "must be positive", height, "give the tree's height in metres")
    parent = skeleton.parent.astype(np.int64)
    points = skeleton.points.astype(np.float64)
    length = np.linalg.norm(points - points[np.maximum(parent, 0)], axis=1)
    bend = 1.0 - np.exp(-length / _natural_length(skeleton, height))
    count = len(parent)
    depth = np.zeros(count, np.int64)
    start = np.zeros((count, 2), np.int64)  # the node at each tier's pivot
    first = np.zeros((count, 2), np.int64)  # the first node of each tier's branch
    extent = np.zeros((count, 3))
    for nodes in levels(parent)[1:]:
        above = parent[nodes]
        depth[nodes] = np.maximum(depth[above], np.minimum(skeleton.level[nodes], _FINE))
        for tier in (_LIMB, _FINE):
            inside, begins = depth[nodes] >= tier, depth[above] < tier
            # A branch that skips a tier has both pivots in one place.
            before = (start[nodes, 0], first[nodes, 0]) if tier == _FINE else (0, 0)
            start[nodes, tier - 1] = np.where(
                inside, np.where(begins, above, start[above, tier - 1]), before[0]
            )
            first[nodes, tier - 1] = np.where(
                inside, np.where(begins, nodes, first[above, tier - 1]), before[1]
            )
        pivot = np.where(depth[nodes] > 0, start[nodes, np.maximum(depth[nodes] - 1, 0)], 0)
        # At the middle of the segment, so that it does not matter how finely a branch is divided.
        arm = np.linalg.norm(0.5 * (points[nodes] + points[above]) - points[pivot], axis=1)
        steepest = np.divide(_STEEPEST * length[nodes], arm, out=np.ones(len(nodes)), where=arm > 0)
        extent[nodes] = extent[above]
        growth = (1.0 - extent[nodes, depth[nodes]]) * bend[nodes]
        extent[nodes, depth[nodes]] += np.minimum(growth, steepest)
    return WindWeights(
        depth=depth.astype(np.int32),
        pivot=points[start].astype(np.float32),
        extent=extent.astype(np.float32),
        phase=_phases(points, start, first, height, seed),
    )


def _natural_length(skeleton: Skeleton, height: float) -> NDArray[np.float64]:
    """How long branches of each node's thickness usually are, (n,) [m]."""
    radius = skeleton.radius.astype(np.float64)
    foot = radius[0] if radius[0] > 0 else radius.max()
    relative = radius / foot if foot > 0 else np.ones(len(radius))
    usual: NDArray[np.float64] = height * np.clip(relative, _THINNEST, 1.0) ** _STIFFNESS
    return usual


def _phases(
    points: NDArray[np.float64],
    start: NDArray[np.int64],
    first: NDArray[np.int64],
    height: float,
    seed: int,
) -> NDArray[np.float32]:
    """The phases of limb and finer branch, (n, 2), read a little along the branch."""
    waves = unit(np.random.default_rng(seed).normal(size=(2, 3)))
    phase = np.empty(start.shape)
    for tier, length in enumerate(_WAVES):
        pivot = points[start[:, tier]]
        place = pivot / height + _READ_AT * unit(points[first[:, tier]] - pivot)
        phase[:, tier] = np.sum(place * waves[tier], axis=1) / length
    # Rounding up to 1 would be the same place of the cycle, but out of range.
    return np.minimum(phase % 1.0, np.nextafter(np.float32(1), np.float32(0))).astype(np.float32)
