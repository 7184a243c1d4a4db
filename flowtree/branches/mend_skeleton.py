"""A skeleton from elsewhere, made fit to carry wood and leaves."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from flowtree import check
from flowtree.branches.da_vinci_radii import da_vinci_radii
from flowtree.branches.order_branches import order_branches
from flowtree.geometry.parent_array import levels
from flowtree.model.skeleton import Skeleton
from flowtree.params import ThicknessParams

# Of the skeleton's extent: what lies nearer together is one place.
_SAME_PLACE = 1e-6
_LEAST_HEIGHT, _MOST_HEIGHT = 0.01, 200.0  # [m]; the highest tree on earth has 116


def mend_skeleton(
    skeleton: Skeleton,
    *,
    height: float | None = None,
    up: Literal["y", "z"] = "y",
    params: ThicknessParams = ThicknessParams(),
) -> tuple[Skeleton, tuple[str, ...]]:
    """Repairs what files of other programs bring along, and says so.

    Nodes in the place of their parent are dropped. A radius of 0 counts as unknown: it is filled by Da
    Vinci's rule between those that are known (Particle Flows, section 8). Radii that grow toward a tip,
    which measured ones do all over, become the mean of the least on the way to the root and the greatest
    behind the node: a branch that only tapers stays as it is.

    Args:
        skeleton: one tree, the root at the origin, parents before children.
        height: to which the whole is scaled, root to highest node [m]; None leaves it.
        up: the axis that points to the sky; z is turned up.
        params: of the radii that are unknown.

    Returns: the skeleton with levels by its radii, and what was done, in words.

    Raises:
        InputError: a single node, all in one place, none above the root, or a height beyond all trees.
    """
    notes: list[str] = []
    if up == "z":
        skeleton = replace(skeleton, points=skeleton.points[:, [0, 2, 1]] * np.array([1, 1, -1], np.float32))
    skeleton = _without_doubles(skeleton, notes)
    rise = float(skeleton.points[:, 1].max())
    check.require(
        rise > _SAME_PLACE * _extent(skeleton),
        "skeleton",
        "must rise above its root",
        f"a highest node at {rise:.3g}",
        "say which axis points up (y or z), or turn it",
    )
    reach = skeleton.points[:, 1:].max(axis=0)
    if up == "y" and reach[1] > 2.0 * reach[0]:
        notes.append(
            f"reaches {reach[1]:.3g} m along z and {reach[0]:.3g} m up: if z points up there, say so"
        )
    if height is not None:
        skeleton = _scaled(skeleton, height / rise)
    tall = float(skeleton.points[:, 1].max())
    check.require(
        _LEAST_HEIGHT <= tall <= _MOST_HEIGHT,
        "skeleton",
        f"must be {_LEAST_HEIGHT:g} to {_MOST_HEIGHT:g} m high",
        f"{tall:.4g} m",
        "give its height in metres",
    )
    skeleton = _with_radii(skeleton, params, notes)
    return replace(skeleton, level=order_branches(skeleton.parent, skeleton.radius)), tuple(notes)


def _extent(skeleton: Skeleton) -> float:
    return float(np.ptp(skeleton.points.astype(np.float64), axis=0).max())


def _without_doubles(skeleton: Skeleton, notes: list[str]) -> Skeleton:
    """The skeleton without nodes in the place of the node they grow from."""
    count = len(skeleton.parent)
    check.require(count > 1, "skeleton", "needs a segment", "a single node", "choose another file")
    least = _SAME_PLACE * _extent(skeleton)
    check.require(least > 0.0, "skeleton", "needs a segment", "all nodes in one place", "choose another file")
    # The kept node that stands for each: its own, or the one that stands for its parent.
    stands, kept = np.arange(count), np.ones(count, np.bool_)
    points = skeleton.points.astype(np.float64)
    for nodes in levels(skeleton.parent)[1:]:
        above = stands[skeleton.parent[nodes]]
        double = ((points[nodes] - points[above]) ** 2).sum(axis=1) <= least**2
        stands[nodes[double]] = above[double]
        kept[nodes[double]] = False
    dropped = count - int(kept.sum())
    if not dropped:
        return skeleton
    notes.append(f"{dropped} {'node' if dropped == 1 else 'nodes'} dropped that lay in their parent's place")
    radius = skeleton.radius.copy()
    np.maximum.at(radius, stands, skeleton.radius)
    place = np.cumsum(kept) - 1
    up = np.where(skeleton.parent[kept] >= 0, place[stands[skeleton.parent[kept]]], -1)
    return Skeleton(
        parent=up.astype(np.int32),
        points=skeleton.points[kept],
        radius=radius[kept],
        particles=skeleton.particles[kept],
        level=skeleton.level[kept],
        twig=skeleton.twig[kept],
    )


def _scaled(skeleton: Skeleton, factor: float) -> Skeleton:
    points = (skeleton.points.astype(np.float64) * factor).astype(np.float32)
    radius = (skeleton.radius.astype(np.float64) * factor).astype(np.float32)
    return replace(skeleton, points=points, radius=radius)


def _with_radii(skeleton: Skeleton, params: ThicknessParams, notes: list[str]) -> Skeleton:
    """The skeleton with a radius at every node, none of which grows toward a tip."""
    known = skeleton.radius > 0.0
    if not known.any():
        notes.append("no radii in the file: they follow Da Vinci's rule")
        return da_vinci_radii(skeleton, params=params)
    given = _tapering(skeleton.parent, skeleton.radius, known)
    grown = int((np.abs(given - skeleton.radius)[known] > 1e-6 * skeleton.radius[known]).sum())
    if grown:
        notes.append(f"{grown} radii evened out that grew toward the tips")
    if known.all():
        return replace(skeleton, radius=given)
    notes.append(f"{int((~known).sum())} radii missing: they follow Da Vinci's rule between the others")
    bounds = np.stack([np.where(known, given, 0.0), np.where(known, given, np.inf)], axis=1)
    filled = da_vinci_radii(skeleton, trunk_radius=float(given[known].max()), bounds=bounds, params=params)
    return replace(skeleton, radius=filled.radius)


def _tapering(
    parent: NDArray[np.int32], radius: NDArray[np.float32], known: NDArray[np.bool_]
) -> NDArray[np.float32]:
    least = np.where(known, radius, np.inf).astype(np.float64)
    greatest = np.where(known, radius, 0.0).astype(np.float64)
    walk = levels(parent)[1:]
    for nodes in walk:
        least[nodes] = np.minimum(least[nodes], least[parent[nodes]])
    for nodes in reversed(walk):
        np.maximum.at(greatest, parent[nodes], greatest[nodes])
    even = np.where(known, (least + greatest) / 2.0, 0.0)
    return even.astype(np.float32)
