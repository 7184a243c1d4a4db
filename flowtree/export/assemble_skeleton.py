"""From what a skeleton file says to a skeleton that keeps the model's promises."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flowtree import check
from flowtree.export.check_skeleton import MOST_METRES
from flowtree.geometry.parent_array import depths, main_child, parents_first, sum_to_root
from flowtree.model.skeleton import Skeleton


def assemble_skeleton(
    thing: str,
    parent: ArrayLike,
    points: ArrayLike,
    radius: ArrayLike,
    *,
    particles: ArrayLike | None = None,
    level: ArrayLike | None = None,
    twig: ArrayLike | None = None,
) -> Skeleton:
    """Checks the arrays of n nodes in any order and brings them into the model's form.

    Nodes that already come parents first keep their order; a root that lies elsewhere is moved to the origin,
    the tree with it.

    Args:
        thing: the file's name, for the error.
        parent: (n,) index of each node's parent, -1 at the root.
        points: (n, 3) [m].
        radius: (n,) [m], not negative.
        particles: (n,); left out, the number of tips behind each node.
        level: (n,) branching order; left out, a branch goes on in its thickest child.
        twig: (n,); left out, nothing is.

    Raises:
        InputError: no node, several roots or none, a circle, NaN, a negative radius, unequal lengths.
    """
    up = _whole(parent, f"{thing}: parents", None, -1)
    count = len(up)
    check.require(count > 0, thing, "needs a node", "none", "choose a file with a skeleton")
    places = check.array(
        _numbers(points, f"{thing}: points"),
        f"{thing}: points",
        shape=(count, 3),
        dtype=np.float64,
        low=-MOST_METRES,
        high=MOST_METRES,
    )
    thickness = check.array(
        _numbers(radius, f"{thing}: radii"),
        f"{thing}: radii",
        shape=(count,),
        low=0.0,
        high=MOST_METRES,
    )
    inside = int(up.max()) < count
    check.require(inside, thing, f"must name parents below {count}", int(up.max()), "add the missing node")
    roots = int((up == -1).sum())
    check.require(roots < 2, thing, "must hold one tree, with one root", f"{roots} roots", "keep one of them")
    try:
        depths(up)
    except ValueError:
        check.fail(thing, "must lead from every node to the root", "a circle of parents", "break the circle")
    flags = None if twig is None else _whole(twig, f"{thing}: twig", count, 0) != 0
    counts = None if particles is None else _whole(particles, f"{thing}: particles", count, 0)
    orders = None if level is None else _whole(level, f"{thing}: level", count, 0)
    order, sorted_up = np.arange(count), up.astype(np.int32)
    if (up >= order).any():
        order, sorted_up = parents_first(up)
    thickness = thickness[order]
    return Skeleton(
        parent=sorted_up,
        points=(places[order] - places[order[0]]).astype(np.float32),
        radius=thickness,
        particles=_tips_behind(sorted_up) if counts is None else counts[order].astype(np.int32),
        level=_branching_order(sorted_up, thickness) if orders is None else orders[order].astype(np.int32),
        twig=np.zeros(count, np.bool_) if flags is None else flags[order],
    )


def _numbers(values: ArrayLike, thing: str) -> NDArray[Any]:
    """The values as an array; a list of unequal rows is an input error, not numpy's."""
    try:
        return np.asarray(values)
    except (ValueError, OverflowError):
        check.fail(thing, "must be rows of equal length", "others", "repair the file")


def _whole(values: ArrayLike, thing: str, count: int | None, low: int) -> NDArray[np.int64]:
    numbers = _numbers(values, thing)
    if numbers.size == 0:
        numbers = numbers.astype(np.int64)
    whole = numbers.dtype == np.bool_ or np.issubdtype(numbers.dtype, np.integer)
    check.require(whole, thing, "must be whole numbers below 2**31", "others", "repair the file")
    return check.array(numbers, thing, shape=(count,), dtype=np.int64, low=low, high=2**31 - 1)


def _tips_behind(parent: NDArray[np.integer[Any]]) -> NDArray[np.int32]:
    tips = np.ones(len(parent), np.int32)
    tips[parent[parent >= 0]] = 0
    return sum_to_root(parent, tips).astype(np.int32)


def _branching_order(parent: NDArray[np.integer[Any]], radius: NDArray[np.float32]) -> NDArray[np.int32]:
    """0 in the trunk, one more in every child that is not its parent's thickest."""
    main = main_child(parent, radius)
    order = [0] * len(parent)
    for node, up in enumerate(parent.tolist()):
        if up >= 0:
            order[node] = order[up] + (int(main[up]) != node)
    return np.array(order, np.int32)
