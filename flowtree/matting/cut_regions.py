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
    label = (odds > 0.0).astype(np.float32)
    ahead = label.copy()
    right, down = np.zeros_like(label), np.zeros_like(label)
    flow, new = np.empty_like(label), np.empty_like(label)
    gain = _STEP * odds
    least_right, least_down = -cost_right, -cost_down
    step_right, step_down = np.empty_like(label[:, :-1]), np.empty_like(label[:-1])
    for _ in range(rounds):
        # Written over itself, and with bounds apart: half of the time went to fresh memory and to `np.clip`.
        np.subtract(ahead[:, 1:], ahead[:, :-1], out=step_right)
        step_right *= _STEP
        right[:, :-1] += step_right
        np.subtract(ahead[1:], ahead[:-1], out=step_down)
        step_down *= _STEP
        down[:-1] += step_down
        np.maximum(right, least_right, out=right)
        np.minimum(right, cost_right, out=right)
        np.maximum(down, least_down, out=down)
        np.minimum(down, cost_down, out=down)
        np.add(right, down, out=flow)
        flow[:, 1:] -= right[:, :-1]
        flow[1:] -= down[:-1]
        flow *= _STEP
        np.add(label, flow, out=new)
        new += gain
        np.maximum(new, _EMPTY, out=new)
        np.minimum(new, _FULL, out=new)
        np.multiply(new, np.float32(2.0), out=ahead)
        ahead -= label
        label, new = new, label
    return label
