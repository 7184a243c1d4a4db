"""Removes branches that cross gaps of a leafy crown."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flowtree.branches.prune_branches import Branches, drop_branches
from flowtree.geometry.cover_canvas import CELLS, lay_canvas
from flowtree.geometry.find_painted import find_painted
from flowtree.geometry.parent_array import levels, main_child, sum_to_root
from flowtree.model.camera import Camera
from flowtree.model.edit import PaintedEdit
from flowtree.model.guessed_view import GuessedView
from flowtree.model.matte import Matte

_EMPTY = 0.01  # mean alpha of a cell in which there is a gap
_THIN = 0.15  # the same of a guess, whose crowns fade away, of the mean alpha where its leaves are
_KNOWN = 0.9  # how surely a cell's alpha must be known


def drop_rods(
    branches: Branches,
    mattes: Sequence[Matte],
    cameras: Sequence[Camera],
    *,
    height: float,
    longest: float,
    edits: Sequence[PaintedEdit] = (),
    between: Sequence[GuessedView] = (),
) -> Branches:
    """Drops side branches that run far through gaps, where a matte shows next to nothing, for few particles.

    A particle that crosses a gap before it meets others leaves a rod in the open that no picture shows. The
    part of the crown that it came from is borne by its neighbours.

    Args:
        branches: to choose from; the limbs that the pictures show stay.
        mattes: one a view.
        cameras: theirs.
        height: of the tree [m].
        longest: way through gaps, times the root of a side branch's particles, from which on it goes [m].
        between: the volume from where no photograph looks: a crown's thin rim there is a gap, too.
        edits: one a view, or none: what somebody painted beside the crown has no neighbours, so what bears
            it stays.
    """
    parent, points, own, limb = branches
    above = np.maximum(parent, 0)
    middle = (points + points[above]) / 2
    empty = np.zeros(len(parent), np.bool_)
    for matte, camera in zip(mattes, cameras, strict=True):
        canvas = lay_canvas(matte.alpha, matte.unknown, camera, cell=height / CELLS)
        flat = canvas.flat(middle)
        gap = (canvas.wanted < _EMPTY) & (canvas.known > _KNOWN)
        empty |= canvas.spread(gap.astype(np.float32))[canvas.index(flat[:, 0], flat[:, 1])] > 0
    for guess in between:
        canvas = lay_canvas(guess.alpha, None, guess.camera, cell=height / CELLS)
        flat = canvas.flat(middle)
        usual = (canvas.wanted**2).sum() / max(float(canvas.wanted.sum()), 1e-9)
        thin = canvas.wanted < _THIN * usual
        empty |= canvas.spread(thin.astype(np.float32))[canvas.index(flat[:, 0], flat[:, 1])] > 0
    way = np.linalg.norm(points - points[above], axis=1) * (empty & ~limb)
    particles = sum_to_root(parent, own)
    most = way.copy()  # through gaps, from the node's parent to any tip behind it
    for nodes in reversed(levels(parent)[1:]):
        ahead = np.zeros(len(parent))
        np.maximum.at(ahead, parent[nodes], most[nodes])
        most += ahead
    side = ~limb & (parent >= 0) & (main_child(parent, particles)[above] != np.arange(len(parent)))
    wanted = (
        sum_to_root(parent, find_painted(points, cameras[: len(edits)], edits).added.astype(np.int64)) > 0
    )
    return drop_branches(branches, side & ~wanted & (most > longest * np.sqrt(particles)))
