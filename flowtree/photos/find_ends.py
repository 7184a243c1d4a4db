"""Finds where the tree of a matte stands on the ground and where it ends."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from flowtree import check

_SOLID = 0.35  # alpha of a pixel that counts; twigs thinner than a pixel still reach it
_WIDE = 0.25  # of the tree's height: the last rows of a stem are narrower
_FOOT_ROWS = 0.03  # of the tree's height: the stretch that says where the trunk's middle is
_CUT = 0.03  # of the tree's height: less of it on the picture's edge is a twig that ends there


@dataclass(frozen=True)
class Ends:
    """Foot and top of a tree in its matte.

    Attributes:
        foot: (x, y) [pixels] where the trunk leaves the ground, or the picture.
        top: row [pixels] where the crown ends.
        missing: the picture's sides, of "left", "right", "top", "bottom", where the tree leaves it; at the
            bottom a trunk that just ends there is among them.
    """

    foot: tuple[float, float]
    top: float
    missing: tuple[str, ...]


def find_ends(alpha: NDArray[np.float32]) -> Ends:
    """Foot and top of the largest thing in the matte and of what lies near it: specks count for nothing.

    The foot is the middle of the trunk in its last rows; where the crown comes down to the ground it is below
    the middle of the whole tree. The top is the highest row with a solid pixel.

    Args:
        alpha: (h, w) in 0..1.

    Raises:
        InputError: an empty alpha.
    """
    solid = _tree_of(alpha)
    rows = np.flatnonzero(solid.any(axis=1))
    check.require(
        len(rows) > 0, "matte", "must show a tree", "an empty alpha", "check the matte of this photo"
    )
    first, last = int(rows[0]), int(rows[-1])
    tall = last + 1 - first
    weight = np.where(solid, alpha, 0.0).astype(np.float64)
    mass = weight.sum(axis=1)
    # The last row that carries its share: a root or a blade of grass hangs lower than the trunk ends.
    near = mass[max(first, last - round(0.1 * tall)) : last + 1]
    enough = 0.3 * float(np.median(near[near > 0.0]))
    while last > first and mass[last] < enough:
        last -= 1
    low = weight[max(first, last - round(_FOOT_ROWS * tall)) : last + 1].sum(axis=0)
    if _quantile(low, 0.9) - _quantile(low, 0.1) > _WIDE * tall:  # a crown down to the ground hides the stem
        x = float(np.median([_quantile(row, 0.5) for row in weight[first : last + 1] if row.any()]))
    else:
        x = _quantile(low, 0.5)  # the median is the stem's even where a branch hangs beside it
    edges = {"left": weight[:, 0], "right": weight[:, -1], "top": weight[0]}
    cut = [side for side, edge in edges.items() if float(edge.sum()) > _CUT * tall]
    if last == alpha.shape[0] - 1:
        cut.append("bottom")
    return Ends((x, float(last + 1)), float(first), tuple(cut))


def _quantile(mass: NDArray[np.float64], share: float) -> float:
    """Where along a row of pixels the given share of its mass is reached."""
    run = np.cumsum(mass) / max(float(mass.sum()), 1e-9)
    column = int(np.searchsorted(run, share))
    before = float(run[column - 1]) if column else 0.0
    return float(column + (share - before) / max(float(run[column]) - before, 1e-9))


def _tree_of(alpha: NDArray[np.float32]) -> NDArray[np.bool_]:
    """The solid pixels of the largest thing, with the leaves that float near it."""
    solid = alpha > _SOLID
    reach = 2 * max(1, round(0.01 * alpha.shape[0])) + 1
    joined = cv2.dilate(solid.astype(np.uint8), np.ones((reach, reach), np.uint8))
    count, parts = cv2.connectedComponents(joined, connectivity=8)
    mass = np.bincount(parts.ravel(), np.where(solid, alpha, 0.0).ravel(), count)
    mass[0] = 0.0
    largest: NDArray[np.bool_] = solid & (parts == int(mass.argmax())) & (parts > 0)
    return largest
