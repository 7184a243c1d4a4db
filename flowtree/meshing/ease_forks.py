"""Lets thick branches grow out of their parents in a curve."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flowtree.meshing.branch_axes import BranchAxes, Floats, Ints

_BELOW = 1.6  # how far below the fork the curve begins, in radii of the parent
_ABOVE = 1.5  # how far along the branch it ends, in radii of the parent
_ROOM = 1.15  # the branch must be this much longer than the part that the curve replaces
_PLACES = np.array([0.0, 0.25, 0.5, 0.75, 1.0])
_WIDTHS = np.array([0.75, 1.0, 1.14, 1.1, 1.0])  # in radii of the branch: a collar where it comes out


def ease_forks(
    axes: BranchAxes, points: Floats, parent: Ints, fork: Ints, fork_radius: Floats, thick: NDArray[np.bool_]
) -> tuple[BranchAxes, NDArray[np.bool_]]:
    """Bends the bases of thick branches into the axes of their parents.

    A thick branch that begins at the fork with its full width overhangs its parent below like a stuck-on
    pipe. Wood of a real fork runs on from below: so the axis begins on the parent's axis below the fork, as a
    quadratic Bézier curve whose middle control point is the fork, and leaves the bark at a small angle.

    Args:
        axes: of all branches; each begins at its fork.
        points: (n, 3) [m], the skeleton's.
        parent: (n,), the skeleton's.
        fork: (c,), the node that each branch leaves.
        fork_radius: (c,) [m], of the parent there.
        thick: (c,), branches to bend, if they are long enough.

    Returns: the axes, and which branches (c,) were bent.
    """
    reach = _ABOVE * fork_radius
    bent = thick & (axes.length() > _ROOM * reach)
    chosen = np.flatnonzero(bent)
    if not len(chosen):
        return axes, bent
    count = len(_PLACES)
    # A place on the curve is carried by the segment from which it was bent.
    along = reach[chosen][:, None] * np.maximum(_PLACES, 1e-3)
    above, *_ = axes.between(np.repeat(chosen, count), along.ravel())
    _, end, end_radius = axes.between(chosen, reach[chosen])
    begin = _points_below(points, parent, fork[chosen], _BELOW * fork_radius[chosen])
    kept = axes.at(~(bent[axes.chain] & (axes.arc() <= reach[axes.chain])))

    t = _PLACES[None, :, None]
    corner = points[fork[chosen]][:, None]
    curve = (1.0 - t) ** 2 * begin[:, None] + 2.0 * t * (1.0 - t) * corner + t**2 * end[:, None]
    return kept.insert(
        np.repeat(kept.first[chosen], count),
        curve.reshape(-1, 3),
        (end_radius[:, None] * _WIDTHS).ravel(),
        np.repeat(chosen, count),
        axes.node[above],
    ), bent


def _points_below(points: Floats, parent: Ints, node: Ints, reach: Floats) -> Floats:
    """(n, 3) [m], the points at a distance (n,) below nodes (n,) on the way to the root, or the root."""
    here, left, place = node.copy(), reach.copy(), points[node].copy()
    while True:
        active = (left > 0.0) & (parent[here] >= 0)
        if not active.any():
            return place
        below = np.where(active, parent[here], here)
        step = points[below] - place
        length = np.linalg.norm(step, axis=1)
        share = np.where(length > left, left / np.maximum(length, 1e-300), 1.0)
        place = np.where(active[:, None], place + share[:, None] * step, place)
        left = np.where(active, left - length, left)
        here = below
