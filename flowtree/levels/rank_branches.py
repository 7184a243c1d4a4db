"""Which branches a tree would miss most."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flowtree.geometry.parent_array import depths, main_child
from flowtree.geometry.spread_order import spread_order
from flowtree.model.skeleton import Skeleton

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True)
class BranchRank:
    """A skeleton's branches, from the one that is missed most to the one missed least.

    Attributes:
        branch: (n,) the rank of each node's branch, 0 the trunk's; a branch comes after the one it leaves.
        parent: (c,) the rank of the branch that each leaves; -1 for the trunk.
        fork: (c,) the node at which it leaves it; -1 for the trunk.
    """

    branch: Ints
    parent: Ints
    fork: Ints


def rank_branches(skeleton: Skeleton, *, seed: int = 0) -> BranchRank:
    """Ranks branches so that every beginning of the ranks is a tree that looks like the whole.

    Only the largest branches would leave a crown without its outline: so small ones are drawn, with a chance
    that grows with their area (order sampling; Ohlsson 1998, sequential Poisson sampling), and evenly over
    the crown, as their random numbers follow `spread_order`. A branch of area a, n nodes and random number u,
    0 to 1, is worth a / (n u), and never less than what it carries.

    Args:
        skeleton: n nodes.
        seed: of the draw.
    """
    parent = skeleton.parent.astype(np.int64)
    branch, fork = _trace(skeleton, parent)
    count = len(fork)
    points = skeleton.points.astype(np.float64)
    radius = skeleton.radius.astype(np.float64)
    above = np.maximum(parent, 0)
    length = np.linalg.norm(points - points[above], axis=1) * (parent >= 0)
    # A side branch's first segment is as thick as its node: the fork's radius is its parent's.
    starts = np.zeros(len(parent), np.bool_)
    starts[np.flatnonzero(branch != branch[above])] = True
    width = radius + np.where(starts, radius, radius[above])
    area = np.bincount(branch, length * width, minlength=count)
    nodes = np.bincount(branch, minlength=count)
    middle = np.stack([np.bincount(branch, axis, minlength=count) for axis in points.T], axis=1)
    draw = np.empty(count)
    draw[spread_order(middle / nodes[:, None], seed=seed)] = (np.arange(count) + 0.5) / count
    worth = area / (nodes * draw)
    carrier = np.where(fork >= 0, branch[np.maximum(fork, 0)], -1)
    depth = depths(carrier)
    for step in range(int(depth.max(initial=0)), 0, -1):
        which = np.flatnonzero(depth == step)
        np.maximum.at(worth, carrier[which], worth[which])
    order = np.lexsort((depth, -worth))
    rank = np.empty(count, np.int64)
    rank[order] = np.arange(count)
    ranked = carrier[order]
    return BranchRank(
        branch=rank[branch],
        parent=np.where(ranked >= 0, rank[np.maximum(ranked, 0)], -1),
        fork=fork[order],
    )


def _trace(skeleton: Skeleton, parent: Ints) -> tuple[Ints, Ints]:
    """The branch of each node (n,), the trunk's 0, and the node that each branch leaves (c,), -1 for none.

    A branch goes on into the thickest child, of equals into the one of most particles.
    """
    weight = np.empty(len(parent), np.int64)
    weight[np.lexsort((skeleton.particles, skeleton.radius))] = np.arange(len(parent))
    head = np.ones(len(parent), np.bool_)
    carried = main_child(parent, weight)
    head[carried[carried >= 0]] = False
    jump = np.where(head, np.arange(len(parent)), parent)
    while True:
        further = jump[jump]
        if np.array_equal(further, jump):
            break
        jump = further
    heads = np.flatnonzero(head)
    return np.searchsorted(heads, jump), parent[heads]
