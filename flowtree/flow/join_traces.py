"""From recorded positions to one tree of traces (Particle Flows, section 6)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from flowtree.geometry.parent_array import depths, parents_first, sum_to_root
from flowtree.model.traces import FlowTraces


def join_traces(
    trace: NDArray[np.float32],
    begin_step: NDArray[np.int32],
    end_step: NDArray[np.int32],
    joined: NDArray[np.int32],
    *,
    seed_points: NDArray[np.float32],
) -> FlowTraces:
    """Connects every particle's path to whom it joined, and all of them to the root at the foot.

    A particle that never arrived (``end_step`` -1, not joined) is connected, with everything that joined it,
    to the nearest point of a path that did: no input leaves a particle unconnected.

    Args:
        trace: (steps + 1, n, 3) [m], every particle's place at the beginning of each step.
        begin_step: (n,) step in which it set off, -1 for never.
        end_step: (n,) last step with a place of its own.
        joined: (n,) the particle it went over to, -1 for none.
        seed_points: (n, 3) [m], where each started.

    Returns: the traces; node 0 is the root at the origin with all particles.
    """
    last = len(trace) - 1
    count = len(begin_step)
    begin = np.where(begin_step >= 0, begin_step, last)
    end = np.maximum(np.where(end_step >= 0, end_step, last), begin)
    steps = np.arange(last + 1)[:, None]
    there = (steps >= begin) & (steps <= end)
    node = np.full(there.shape, -1, np.int64)
    node[there] = np.arange(1, there.sum() + 1)
    step, particle = np.nonzero(there)
    points = np.concatenate([np.zeros((1, 3), np.float32), trace[step, particle]])
    follows = step < end[particle]
    goes_over = ~follows & (joined[particle] >= 0)
    parent = np.zeros(len(step) + 1, np.int64)  # who arrived is connected to the root
    parent[0] = -1
    parent[1:][follows] = node[step[follows] + 1, particle[follows]]
    parent[1:][goes_over] = node[step[goes_over] + 1, joined[particle[goes_over]]]
    lost = np.flatnonzero(~follows & ~goes_over & (end_step[particle] < 0)) + 1
    own = np.zeros(len(parent), np.int32)
    own[node[begin, np.arange(count)]] = 1
    parent = _connect_lost(parent, points, lost)
    order, parent_sorted = parents_first(parent)
    recorded = np.concatenate([[last + 1], step]).astype(np.int32)
    return FlowTraces(
        parent=parent_sorted,
        points=points[order],
        particles=sum_to_root(parent_sorted, own[order]),
        step=recorded[order],
    )


def _connect_lost(
    parent: NDArray[np.int64], points: NDArray[np.float32], lost: NDArray[np.int64]
) -> NDArray[np.int64]:
    """Hangs the ends of lost paths to the nearest point of a path that reached the root."""
    if not len(lost):
        return parent
    roots = parent.copy()
    roots[lost] = -1
    reached = _root_of(roots) == 0
    tree = cKDTree(points[reached])
    parent = parent.copy()
    parent[lost] = np.flatnonzero(reached)[tree.query(points[lost])[1]]
    return parent


def _root_of(parent: NDArray[np.int64]) -> NDArray[np.int64]:
    """The root above every node, by pointer doubling."""
    up = np.where(parent >= 0, parent, np.arange(len(parent)))
    for _ in range(int(depths(parent).max()).bit_length() + 1):
        up = up[up]
    return up
