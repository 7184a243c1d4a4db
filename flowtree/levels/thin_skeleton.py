"""Fewer and thicker branches that hide as much sky as all of them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flowtree.levels.rank_branches import BranchRank
from flowtree.model.skeleton import Skeleton

Floats = NDArray[np.float64]
_STEPS, _CLOSE = 20, 1e-5  # of the search, at most, and what it may miss, of the largest k


def thin_skeleton(
    skeleton: Skeleton, rank: BranchRank, count: int, *, most: float, share: float = 1.0
) -> tuple[Skeleton, NDArray[np.int32]]:
    """The branches of the first ranks, the thin ones thicker by what is lost with the others.

    Every radius r becomes the root of r² + k²: thick branches hardly change, and no branch becomes thicker
    than the one it leaves. k is the least with which all that stays, seen from the side, has ``share`` of the
    area of the whole skeleton, but not above ``most``.

    Args:
        skeleton: n nodes.
        rank: of its branches.
        count: branches to keep, at least 1.
        most: largest k [m].
        share: of the whole area; 1 unless the mesh will lose some that is to be made up for.

    Returns: the skeleton of what stays, and for each node (n,) the one of it that takes its place: itself, or
        where its way to the root meets what stays.
    """
    stays = rank.branch < count
    if stays.all() and share <= 1.0:
        return skeleton, np.arange(len(stays), dtype=np.int32)
    place = np.cumsum(stays) - 1
    parent = skeleton.parent.astype(np.int64)
    # Whole branches go, so a branch that is gone hangs from one that stays or from one that is gone too.
    jump = np.where(stays, np.arange(len(parent)), parent)
    while not stays[jump].all():
        jump = jump[jump]
    width, length = _widths(skeleton)
    wanted = share * float(width @ length)
    thinned = Skeleton(
        parent=np.where(parent[stays] >= 0, place[np.maximum(parent[stays], 0)], -1).astype(np.int32),
        points=skeleton.points[stays],
        radius=_thicken(skeleton.radius[stays], width[stays], length[stays], wanted, most),
        particles=skeleton.particles[stays],
        level=skeleton.level[stays],
        twig=skeleton.twig[stays],
    )
    return thinned, place[jump].astype(np.int32)


def _widths(skeleton: Skeleton) -> tuple[Floats, Floats]:
    """Radius and length (n,) [m] of every segment."""
    above = np.maximum(skeleton.parent, 0)
    points = skeleton.points.astype(np.float64)
    length: Floats = np.linalg.norm(points - points[above], axis=1)
    return skeleton.radius.astype(np.float64), length


def _thicken(
    radius: NDArray[np.float32], width: Floats, length: Floats, wanted: float, most: float
) -> NDArray[np.float32]:
    """The radii with the k of `thin_skeleton`, by Newton's method: the area is convex in k.

    So every step from the right of the root ends at its right again.
    """
    square, k = width**2, most
    for _ in range(_STEPS):
        slant = np.sqrt(square + k * k)
        slope = k * float(np.sum(length / np.maximum(slant, 1e-12)))
        step = (float(slant @ length) - wanted) / max(slope, 1e-12)
        if step <= _CLOSE * most:
            break
        k = max(k - step, 0.0)
    return np.hypot(radius.astype(np.float64), k).astype(np.float32)
