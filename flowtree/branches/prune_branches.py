"""Removes what ends inside the wood, and wires."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flowtree.geometry.parent_array import levels, main_child, sum_to_root

#: Parents, points [m], own particles, and whether the pictures show the limb, of n nodes.
Branches = tuple[NDArray[np.int32], NDArray[np.float64], NDArray[np.int32], NDArray[np.bool_]]

#: Radii of its limb that a side branch must be longer than: what is shorter is a stub.
STUB = 4.0


def prune_branches(
    parent: NDArray[np.int32],
    points: NDArray[np.float64],
    own: NDArray[np.int32],
    limb: NDArray[np.bool_],
    *,
    shortest: float,
    limb_radius: float,
    longest_lone: float,
) -> Branches:
    """Drops side branches that end inside the limb they grow from, and stray wires.

    Args:
        parent: (n,).
        points: (n, 3) [m].
        own: (n,) particles that set off at each node; those of a dropped branch are given to its fork.
        limb: (n,) nodes of limbs that the pictures show: they stay. A limb's parent is one, too.
        shortest: side branches shorter than this go [m].
        limb_radius: rough radius of the trunk [m]; a limb of p of all P particles has
            ``limb_radius * sqrt(p / P)``, and a side branch must be longer than `STUB` times that, besides
            ``shortest``.
        longest_lone: a side branch of p particles longer than this times ``sqrt(p)`` goes [m]: what a stray
            particle left on its way alone is a wire, not a branch.

    Returns: parent, points, own and limb of what is left.
    """
    particles = sum_to_root(parent, own)
    carries_on = main_child(parent, particles)
    depth_levels = levels(parent)
    segment = np.linalg.norm(points - points[np.maximum(parent, 0)], axis=1)
    reach = np.zeros(len(parent))  # from the node to the farthest tip behind it
    for nodes in reversed(depth_levels[1:]):
        np.maximum.at(reach, parent[nodes], reach[nodes] + segment[nodes])
    radius = limb_radius * np.sqrt(particles / max(int(particles[0]), 1))
    above = np.maximum(parent, 0)
    side = ~limb & (parent >= 0) & (carries_on[above] != np.arange(len(parent)))
    length = reach + segment
    gone = side & ((length < shortest + STUB * radius[above]) | (length > longest_lone * np.sqrt(particles)))
    return drop_branches((parent, points, own, limb), gone)


def drop_branches(branches: Branches, gone: NDArray[np.bool_]) -> Branches:
    """What is left without some nodes (n,) and all behind them, whose particles their forks get."""
    parent, points, own, limb = branches
    gone = gone.copy()
    home = np.arange(len(parent))  # the node that keeps a dropped node's particles
    for nodes in levels(parent)[1:]:
        inherits = gone[parent[nodes]]
        gone[nodes] |= inherits
        home[nodes] = np.where(gone[nodes], home[parent[nodes]], nodes)
    index = np.cumsum(~gone) - 1
    kept = np.bincount(index[home], weights=own, minlength=int((~gone).sum())).astype(np.int32)
    stays = parent[~gone]
    return np.where(stays >= 0, index[stays], -1).astype(np.int32), points[~gone], kept, limb[~gone]
