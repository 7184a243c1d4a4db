"""Two regions with a short border: the minimal cut of a picture."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

_EMPTY, _FULL = np.float32(0.0), np.float32(1.0)
_STEP = np.float32(8.0**-0.5)  # of both the primal and the dual variable: their product times 8 is at most 1


def cut_regions(
    odds: NDArray[np.float32],
    cost_right: NDArray[np.float32],
    cost_down: NDArray[np.float32],
    *,
    rounds: int,
) -> NDArray[np.float32]:
    """Minimises the border's cost less the odds inside it, over all regions.

    The convex form of the minimal cut (Chan, Esedoglu and Nikolova 2006): a label may lie between 0 and 1,
    and any threshold of the minimum is a best region. Solved by the primal-dual steps of Chambolle and Pock
    (2011) with a fixed number of rounds; labels that have not settled by then lie between 0 and 1.

    Args:
        odds: (h, w) log-odds that a pixel lies inside.
        cost_right: (h, w) >= 0, of a border between a pixel and its right neighbour; the last column's is not
            used.
        cost_down: (h, w) >= 0, the same for the neighbour below.
        rounds: steps of the solver.

    Returns: (h, w) in 0..1.
    """
    shape, width = odds.shape, odds.shape[1]
    # Rows behind one another: whole pictures are read straight through. No border lies between two rows.
    label = (odds > 0.0).astype(np.float32).ravel()
    ahead = label.copy()
    right, down = np.zeros_like(label), np.zeros_like(label)
    flow, new = np.empty_like(label), np.empty_like(label)
    gain = (_STEP * odds).ravel()
    most_right = cost_right.copy()
    most_right[:, -1] = 0.0
    most_right, most_down = most_right.ravel()[:-1], cost_down.ravel()[:-width]
    least_right, least_down = -most_right, -most_down
    step_right, step_down = np.empty_like(most_right), np.empty_like(most_down)
    to_right, to_below = right[:-1], down[:-width]
    for _ in range(rounds):
        # Written over itself, and with bounds apart: half of the time went to fresh memory and to `np.clip`.
        np.subtract(ahead[1:], ahead[:-1], out=step_right)
        step_right *= _STEP
        to_right += step_right
        np.subtract(ahead[width:], ahead[:-width], out=step_down)
        step_down *= _STEP
        to_below += step_down
        np.maximum(to_right, least_right, out=to_right)
        np.minimum(to_right, most_right, out=to_right)
        np.maximum(to_below, least_down, out=to_below)
        np.minimum(to_below, most_down, out=to_below)
        np.add(right, down, out=flow)
        flow[1:] -= to_right
        flow[width:] -= to_below
        flow *= _STEP
        np.add(label, flow, out=new)
        new += gain
        np.maximum(new, _EMPTY, out=new)
        np.minimum(new, _FULL, out=new)
        np.multiply(new, np.float32(2.0), out=ahead)
        ahead -= label
        label, new = new, label
    return label.reshape(shape)
