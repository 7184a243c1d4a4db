"""Drawn branches join the attractor graph."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree
from skimage.graph import MCP_Geometric

from flowtree.attraction.growing_tree import GrowingTree
from flowtree.geometry.polylines import arc_lengths, drop_repeats, subdivide_polyline

_TOUCH = 0.012  # of the height: strokes nearer than this touch
_SPACING = 0.0075  # of the height: nodes along a stroke
_LEAST_SPACING = 0.75  # cells
_MOST_NODES = 2000  # of a stroke, besides those drawn
_SEARCHES = 16  # Dijkstra searches at most, however many strokes there are
_ALONG = 0.3  # what a step along the tree costs of a step beside it
_UPPER = 0.8  # an upper end is the branch's base only if it is this much cheaper to reach than the lower one

_Array = NDArray[np.float64]


def attach_strokes(
    tree: GrowingTree, cost: NDArray[np.float64], strokes: Sequence[_Array], *, tall: float
) -> None:
    """Adds every stroke to the tree exactly as drawn.

    A stroke that touches the tree, or a stroke already in it, joins there, and in both directions if it
    touches in its middle. The others are joined one by one, the nearest first, by a livewire path from the
    end that is the cheaper one to reach; of two similar ends the lower one.

    Args:
        tree: holds at least its root; gets the strokes.
        cost: (h, w) per cell.
        strokes: polylines (k, 2) [cells].
        tall: the tree's height [cells].
    """
    waiting = [_subdivide(drop_repeats(stroke), _SPACING * tall) for stroke in strokes]
    together = max(1, -(-len(waiting) // _SEARCHES))
    while waiting:
        waiting = _attach_touching(tree, waiting, _TOUCH * tall)
        if not waiting:
            return
        # The way to the root counts, not to the nearest node: a limb springs from the stem, not from a tip.
        search = MCP_Geometric(np.where(tree.node_at >= 0, _ALONG * cost, cost))
        total, _ = search.find_costs([tree.cell_of(tree.points[0])])
        waiting = [_nearer_end_first(tree, stroke, total) for stroke in waiting]
        prices = [float(total[tree.cell_of(stroke[0])]) for stroke in waiting]
        chosen = sorted(range(len(waiting)), key=lambda k: prices[k])[:together]
        for k in chosen:
            node = tree.add_path(search.traceback(tree.cell_of(waiting[k][0]))[:-1])
            tree.add_line(node, waiting[k])
        waiting = [stroke for k, stroke in enumerate(waiting) if k not in chosen]


def _subdivide(stroke: _Array, spacing: float) -> _Array:
    """The stroke with nodes near enough for others to touch it, but a bounded number where it goes far."""
    length = float(arc_lengths(stroke)[-1])
    return subdivide_polyline(stroke, max(spacing, _LEAST_SPACING, length / _MOST_NODES))


def _attach_touching(tree: GrowingTree, waiting: list[_Array], touch: float) -> list[_Array]:
    """Attaches the strokes that touch the tree, and those that touch them; returns the others."""
    attached = True
    while attached and waiting:
        attached = False
        nodes = cKDTree(np.array(tree.points))
        left = []
        for stroke in waiting:
            distance, node = nodes.query(stroke)
            nearest = min((0, len(stroke) - 1), key=lambda k: distance[k])
            if distance[nearest] > touch:
                nearest = int(distance.argmin())
            if distance[nearest] > touch:
                left.append(stroke)
                continue
            at = tree.add(int(node[nearest]), stroke[nearest], drawn=True)
            tree.add_line(at, stroke[nearest + 1 :])
            tree.add_line(at, stroke[:nearest][::-1])
            attached = True
        waiting = left
    return waiting


def _nearer_end_first(tree: GrowingTree, stroke: _Array, total: NDArray[np.float64]) -> _Array:
    """The stroke, turned so that it begins at its base."""
    lower, upper = (stroke, stroke[::-1]) if stroke[0, 1] >= stroke[-1, 1] else (stroke[::-1], stroke)
    cheaper = total[tree.cell_of(upper[0])] < _UPPER * total[tree.cell_of(lower[0])]
    return upper if cheaper else lower
