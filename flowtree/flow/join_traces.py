"""From recorded positions to one tree of traces (Particle Flows, section 6)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from flowtree.geometry.parent_array import depths, parents_first, sum_to_root
from flowtree.model.traces import FlowTraces

_OUTSIDE = 2.0  # times the way to the limb's next place: who set off nearer started inside the limb
_ENTRY = 0.643  # cosine of 50 degrees
_PLACES = 24  # of a limb's places, how many may be passed before it is entered
_FARTHEST = 2.5  # times the way to the limb's next place: no path is drawn out farther than this


def join_traces(
    start: NDArray[np.float32],
    points: NDArray[np.float32],
    step: NDArray[np.int32],
    particle: NDArray[np.int32],
    *,
    begin_step: NDArray[np.int32],
    end_step: NDArray[np.int32],
    joined: NDArray[np.int32],
    last: int,
) -> FlowTraces:
    """Connects every particle's path to whom it joined, and all of them to the root at the foot.

    A limb takes a particle in as soon as it comes within reach, often from beside or from ahead; drawn
    straight to the limb's next place, forks would be square, or hooks. So a path that has come from farther
    away than that enters the limb's at the first later place that lies within 50 degrees of where the limb
    goes on. Who set off inside the limb goes to its next place.

    A particle that never arrived (``end_step`` -1, not joined) is connected, with everything that joined it,
    to the nearest point of a path that did: no input leaves a particle unconnected.

    Args:
        start: (n, 3) [m], where each particle began: the only point of one that never set off.
        points: (m, 3) [m], recorded places, in any order: one for each particle and each step from its first
            to its last.
        step: (m,) the step at whose beginning the particle was there.
        particle: (m,) whose place it is.
        begin_step: (n,) step in which each set off, -1 for never.
        end_step: (n,) last step with a place of its own, -1 for those that were still under way.
        joined: (n,) the particle it went over to, -1 for none.
        last: the last step recorded.

    Returns: the traces; node 0 is the root at the origin with all particles.
    """
    idle = np.flatnonzero(begin_step < 0).astype(np.int32)
    points = np.concatenate([points, start[idle]])
    step = np.concatenate([step, np.full(len(idle), last, np.int32)])
    particle = np.concatenate([particle, idle])
    begin = np.where(begin_step >= 0, begin_step, last).astype(np.int64)
    end = np.maximum(np.where(end_step >= 0, end_step, last), begin)
    length = end - begin + 1
    origin = 1 + np.cumsum(length) - length - begin  # node of (particle, step) is origin[particle] + step
    node = origin[particle] + step
    place = np.zeros((len(node) + 1, 3), np.float32)
    place[node] = points
    recorded = np.full(len(node) + 1, last + 1, np.int32)
    recorded[node] = step
    parent = np.arange(1, len(node) + 2)  # a path goes on to its next point
    parent[0] = -1
    tip = origin + end
    goes_over = joined >= 0
    host = joined[goes_over]
    # A host that arrives in the very step has no later place.
    parent[tip[goes_over]] = origin[host] + np.minimum(end[goes_over] + 1, end[host])
    parent[tip[~goes_over]] = 0  # who arrived is connected to the root
    gap = np.linalg.norm(place[tip] - place[parent[tip]], axis=1)
    guest = goes_over & (np.linalg.norm(place[tip] - start, axis=1) > _OUTSIDE * gap)
    parent[tip[guest]] = _enter(parent, place, tip[guest])
    parent = _connect_lost(parent, place, tip[~goes_over & (end_step < 0)])
    own = np.zeros(len(parent), np.int32)
    own[origin + begin] = 1
    order, sorted_parent = parents_first(parent)
    return FlowTraces(
        parent=sorted_parent,
        points=place[order],
        particles=sum_to_root(sorted_parent, own[order]),
        step=recorded[order],
    )


def _enter(
    parent: NDArray[np.int64], points: NDArray[np.float32], tips: NDArray[np.int64]
) -> NDArray[np.int64]:
    """Where each tip's path best enters the one that it joins: a node between its parent and the root."""
    here, node = points[tips].astype(np.float64), parent[tips]
    far = _FARTHEST * np.linalg.norm(points[node] - here, axis=1)
    best, best_cosine = node.copy(), np.full(len(tips), -np.inf)
    for _ in range(_PLACES):
        way, onward = (
            points[node] - here,
            points[np.maximum(parent[node], 0)] - points[node].astype(np.float64),
        )
        length = np.linalg.norm(way, axis=1)
        cosine = np.einsum("ij,ij->i", way, onward) / np.maximum(
            length * np.linalg.norm(onward, axis=1), 1e-12
        )
        better = (best_cosine < _ENTRY) & (cosine > best_cosine) & (length <= far) & (parent[node] > 0)
        best, best_cosine = np.where(better, node, best), np.where(better, cosine, best_cosine)
        node = np.where(parent[node] > 0, parent[node], node)
    return best


def _connect_lost(
    parent: NDArray[np.int64], points: NDArray[np.float32], lost: NDArray[np.int64]
) -> NDArray[np.int64]:
    """Hangs the ends of lost paths to the nearest point of a path that reached the root."""
    if not len(lost):
        return parent
    parent = parent.copy()
    parent[lost] = -1
    reached = np.flatnonzero(_root_of(parent) == 0)
    parent[lost] = reached[cKDTree(points[reached]).query(points[lost])[1]]
    return parent


def _root_of(parent: NDArray[np.int64]) -> NDArray[np.int64]:
    """The root above every node, by pointer doubling."""
    up = np.where(parent >= 0, parent, np.arange(len(parent)))
    for _ in range(int(depths(parent).max()).bit_length() + 1):
        up = up[up]
    return up
