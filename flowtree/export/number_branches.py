"""Which segments make one branch, numbered as quantitative structure models do."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flowtree.geometry.parent_array import main_child
from flowtree.model.skeleton import Skeleton


@dataclass(frozen=True)
class BranchNumbers:
    """The branch of every node's segment; the root, which has none, counts as the trunk's beginning.

    Attributes:
        extension: (n,) int64, the child that carries the node's branch on; -1 where it ends.
        branch: (n,) int64, counted from 1, the trunk; in the order of the branches' first nodes.
        position: (n,) int64, of the segment in its branch, counted from 1; 0 at the root.
    """

    extension: NDArray[np.int64]
    branch: NDArray[np.int64]
    position: NDArray[np.int64]


def number_branches(skeleton: Skeleton) -> BranchNumbers:
    """Follows each branch: it goes on in the thickest child of its own order."""
    parent, level = skeleton.parent, skeleton.level
    same = (parent >= 0) & (level == level[parent])
    extension = main_child(np.where(same, parent, -1), skeleton.radius)
    follows = np.zeros(len(parent), bool)
    follows[extension[extension >= 0]] = True
    branch, position, last = [1], [0], 1
    for up, continues in zip(parent[1:].tolist(), follows[1:].tolist(), strict=True):
        last += not continues
        branch.append(branch[up] if continues else last)
        position.append(position[up] + 1 if continues else 1)
    return BranchNumbers(extension, np.array(branch, np.int64), np.array(position, np.int64))
