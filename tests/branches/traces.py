"""Traces by chance, of every shape that joined paths can have."""

from __future__ import annotations

import numpy as np

from flowtree.model.traces import FlowTraces


def random_traces(seed: int, count: int = 120, *, collapsed: bool = False) -> FlowTraces:
    """Paths that merge on their way to the origin; some particles set off on the way of others.

    collapsed: many points coincide.
    """
    rng = np.random.default_rng(seed)
    parent = np.full(count, -1, np.int32)
    points = np.zeros((count, 3))
    depth = np.zeros(count, int)
    for i in range(1, count):
        parent[i] = i - 1 if i == 1 or rng.random() < 0.85 else rng.integers(max(0, i - 40), i)
        heading = points[parent[i]] - points[max(parent[parent[i]], 0)] + 0.02 * rng.normal(size=3)
        heading[1] += 0.02
        points[i] = points[parent[i]] + 0.05 * heading / np.linalg.norm(heading)
        depth[i] = depth[parent[i]] + 1
    if collapsed:
        points *= rng.random((count, 1)) < 0.5
    tips = np.bincount(parent[1:], minlength=count) == 0
    particles = np.where(tips, rng.integers(1, 3, count), rng.random(count) < 0.05).astype(np.int32)
    for i in range(count - 1, 0, -1):
        particles[parent[i]] += particles[i]
    return FlowTraces(
        parent=parent,
        points=points.astype(np.float32),
        particles=particles,
        step=(depth.max() - depth).astype(np.int32),
    )


def own_of(parent: np.ndarray, particles: np.ndarray) -> np.ndarray:
    """How many of the particles that pass a node set off there."""
    own = particles.copy()
    np.subtract.at(own, parent[1:], particles[1:])
    return own
