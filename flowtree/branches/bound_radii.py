"""What the pictures say of the branches' thickness."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from flowtree.branches.smooth_branches import smooth_branches
from flowtree.geometry.parent_array import levels, main_child, reach_to_tip
from flowtree.model.attractor import LimbTree
from flowtree.model.skeleton import Skeleton

_THINNEST = 0.0035  # of the height: what is thinner is told by the rule, whose tips are no stumps
_SLENDER = (
    20.0  # radii that a limb is long at least: a shorter one is no limb but a clump before or behind it
)
_FOOT = 0.04  # of the height: the stem's end at the ground is no half width
_INSIDE = 2.0  # radii of what bears it, from the fork on, that hide how thick a side branch is
_ROUNDS = 6  # of smoothing along the branches
_ON = 1e-5  # of the height: as near as this a node is the limb's

_Array = NDArray[np.float64]


def bound_radii(skeleton: Skeleton, limbs: LimbTree) -> _Array:
    """Least and most radius (n, 2) [m] of the branches: 0 and infinity where no picture shows it.

    From node to node the limbs' measured radii are smoothed, and they never grow toward a tip. Of a thick
    limb it is the radius, as far as the limb is slender; of a thin one, which twigs make look wider, only
    the most that it can be.

    Args:
        skeleton: the branches.
        limbs: that the skeleton was grown on.
    """
    count = len(skeleton.parent)
    height = float(np.ptp(skeleton.points[:, 1]))
    distance, limb = cKDTree(limbs.points).query(skeleton.points)
    on_limb = (distance <= _ON * height) & (skeleton.points[:, 1] > _FOOT * height)
    radius = np.where(on_limb, limbs.radius[limb].astype(np.float64), np.nan)
    seen = _settle(skeleton, radius)
    bounds = np.stack([np.zeros(count), np.full(count, np.inf)], axis=1)
    known = ~np.isnan(seen)
    bounds[known, 1] = seen[known]
    thick = known & (seen >= _THINNEST * height)
    bounds[thick, 0] = np.minimum(seen, reach_to_tip(skeleton.parent, skeleton.points) / _SLENDER)[thick]
    return bounds


def _settle(skeleton: Skeleton, radius: _Array) -> _Array:
    """Smooth along the branches, and never more than nearer to the root."""
    parent, particles = skeleton.parent, skeleton.particles
    above = np.maximum(parent, 0)
    side = (parent >= 0) & (main_child(parent, particles)[above] != np.arange(len(parent)))
    radius = _look_beyond(skeleton, radius, side)
    measured = ~np.isnan(radius)
    walk = levels(parent)[1:]
    filled = radius.copy()
    filled[0] = np.nanmax(radius) if measured.any() else 0.0
    for nodes in walk:
        below = filled[parent[nodes]]
        filled[nodes] = np.where(measured[nodes], np.minimum(filled[nodes], below), below)
    # Every branch by itself: no side branch begins as thick as what bears it.
    apart = np.where(side, -1, parent).astype(np.int32)
    smooth = smooth_branches(apart, filled[:, None], particles, rounds=_ROUNDS)[:, 0]
    for nodes in walk:
        smooth[nodes] = np.minimum(smooth[nodes], smooth[parent[nodes]])
    return np.where(measured, smooth, np.nan)


def _look_beyond(skeleton: Skeleton, radius: _Array, side: NDArray[np.bool_]) -> _Array:
    """Where a side branch begins a picture shows what bears it: there it is as thick as farther out."""
    parent, points = skeleton.parent, skeleton.points
    fork = np.zeros(len(parent), np.int64)
    walk = levels(parent)[1:]
    for nodes in walk:
        fork[nodes] = np.where(side[nodes], parent[nodes], fork[parent[nodes]])
    away = np.linalg.norm(points - points[fork], axis=1)
    inside = (fork > 0) & (away < _INSIDE * np.nan_to_num(radius[fork]))
    ahead = main_child(parent, skeleton.particles)
    beyond = radius.copy()
    for nodes in reversed(walk):
        hidden = nodes[inside[nodes]]
        beyond[hidden] = np.where(ahead[hidden] >= 0, beyond[ahead[hidden]], np.nan)
    return beyond
