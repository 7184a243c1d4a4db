"""Which rings a branch would not miss."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flowtree.meshing.branch_axes import BranchAxes, Floats, Ints


def drop_rings(axes: BranchAxes, tolerance: Floats) -> NDArray[np.bool_]:
    """Few rings between which the axis and the radius run straight, up to a tolerance.

    Every branch keeps its first and its last ring. Where the ring that lies farthest from the straight
    between two kept ones, by its centre's distance plus its radius's, is farther than the branch's tolerance
    (c,) [m], it is kept too (Ramer 1972, Douglas and Peucker 1973), in all branches at once.

    Returns: (k,), the rows that stay.
    """
    count = len(axes.chain)
    kept = np.zeros(count, np.bool_)
    kept[axes.first] = kept[axes.last] = True
    arc = axes.arc()
    rows = np.arange(count)
    while True:
        before, after = _neighbours(kept, rows)
        share = (arc - arc[before]) / np.maximum(arc[after] - arc[before], 1e-12)
        share = np.where(kept, 0.0, share)
        straight = axes.center[before] + share[:, None] * (axes.center[after] - axes.center[before])
        radius = axes.radius[before] + share * (axes.radius[after] - axes.radius[before])
        away = np.linalg.norm(axes.center - straight, axis=1) + np.abs(axes.radius - radius)
        far = np.flatnonzero(~kept & (away > tolerance[axes.chain]))
        if not len(far):
            return kept
        # The farthest of each gap; of equally far ones the first.
        order = far[np.lexsort((-far, away[far], before[far]))]
        kept[order[np.append(np.diff(before[order]) != 0, True)]] = True


def _neighbours(kept: NDArray[np.bool_], rows: Ints) -> tuple[Ints, Ints]:
    """For every row the last kept one up to it and the first kept one from it on."""
    before: Ints = np.maximum.accumulate(np.where(kept, rows, 0))
    after: Ints = np.minimum.accumulate(np.where(kept, rows, len(rows))[::-1])[::-1]
    return before, after
