"""Paths along all visible limbs."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray
from skimage.graph import MCP_Geometric

from flowtree.attraction.growing_tree import GrowingTree

_MIDDLE = 0.75  # how near the middle of its limb a path begins
_BESIDE = 0.012  # of the height: what is as near as this to a path is followed
_SHORTEST = 0.03  # of the height: a shorter path is a bump of its carrier
_SHOWN = 0.7  # share of a path along which a limb must show
_MOST = 300  # paths

_Map = NDArray[np.float64]


def cover_limbs(
    tree: GrowingTree,
    cost: _Map,
    ends: _Map,
    limb: NDArray[np.bool_],
    *,
    target: tuple[int, int],
    tall: float,
) -> None:
    """Adds cheapest paths to the target until every limb that the matte shows has one.

    The paper's seeds lie on the silhouette, which says little about the limbs inside a bare crown. Here each
    path begins in the limb's middle that is farthest from the target, among all that no path has followed
    yet: thin ends first, and the paths merge toward the stem by themselves.

    Args:
        tree: gets the paths.
        cost: (h, w) per cell, low along limbs.
        ends: (h, w) how near the middle of a limb that is to be followed a cell is: 0 beside them, 1 in it.
        limb: (h, w) cells of all limbs, also of those that are too thin for a path of their own.
        target: (row, column) to which the paths lead.
        tall: the tree's height [cells].
    """
    near = cv2.dilate(limb.astype(np.uint8), np.ones((3, 3), np.uint8))
    search = MCP_Geometric(cost)
    way, came = search.find_costs([target])
    steps = [(int(down), int(right)) for down, right in search.offsets]
    places = np.argwhere((ends > _MIDDLE) & np.isfinite(way))
    followed = (tree.node_at >= 0).astype(np.uint8)
    reach = max(1, round(_BESIDE * tall))
    disc = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * reach + 1, 2 * reach + 1))
    followed = np.asarray(cv2.dilate(followed, disc), np.uint8)
    count = 0
    for row, column in places[np.argsort(-way[tuple(places.T)], kind="stable")].tolist():
        if followed[row, column] or count == _MOST:
            continue
        path = _walk_to_tree(tree, came, steps, (row, column))
        new = len(path) - (tree.node_at[path[0]] >= 0)
        if new < _SHORTEST * tall or np.mean([near[cell] for cell in path[-new:]]) < _SHOWN:
            continue
        tree.add_path(path)
        count += 1
        for y, x in path:
            cv2.circle(followed, (x, y), reach, 1, -1)


def _walk_to_tree(
    tree: GrowingTree, came: NDArray[np.integer], steps: list[tuple[int, int]], end: tuple[int, int]
) -> list[tuple[int, int]]:
    """The cells of the cheapest path from where it leaves the tree, or from the target, to its end.

    To trace it back to the target takes ten times as long, and most of it is tree already.
    """
    path = [end]
    row, column = end
    while tree.node_at[row, column] < 0 and came[row, column] >= 0:
        down, right = steps[came[row, column]]
        row, column = row - down, column - right
        path.append((row, column))
    path.reverse()
    return path
