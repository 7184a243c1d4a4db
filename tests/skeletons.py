"""Skeletons to test with: random ones of every shape, and the true stems of the shared test trees."""

from __future__ import annotations

import numpy as np

from flowtree.model.skeleton import Skeleton


def random_skeleton(
    seed: int,
    nodes: int = 60,
    *,
    height: float = 10.0,
    stubborn: float = 0.8,
    step_in_thickness: float = 0.0,
    steep: bool = False,
) -> Skeleton:
    """A valid random skeleton: parents before children, Da Vinci radii, levels, some twigs.

    stubborn: chance that a node continues the newest branch; the rest leave an earlier node.
    step_in_thickness: share of nodes whose radius is multiplied by a factor from 0.05 to 3 afterwards.
    steep: side branches leave at a few degrees only.
    """
    rng = np.random.default_rng(seed)
    parent = np.full(nodes, -1, np.int32)
    points = np.zeros((nodes, 3))
    heading = np.tile(np.array([0.0, 1.0, 0.0]), (nodes, 1))
    length = height / max(4.0, np.sqrt(nodes))
    for i in range(1, nodes):
        goes_on = i == 1 or rng.random() < stubborn
        parent[i] = i - 1 if goes_on else rng.integers(i)
        spread = (0.02 if steep else 0.9) if not goes_on else 0.15
        direction = heading[parent[i]] + spread * rng.normal(size=3)
        heading[i] = direction / np.linalg.norm(direction)
        points[i] = points[parent[i]] + heading[i] * length * rng.uniform(0.3, 1.5)
    return skeleton_of(parent, points, rng, step_in_thickness)


def skeleton_of(
    parent: np.ndarray, points: np.ndarray, rng: np.random.Generator, step_in_thickness: float = 0.0
) -> Skeleton:
    """The skeleton of a parent array and its points, with radii from the number of tips above a node."""
    nodes = len(parent)
    particles = np.zeros(nodes, np.int32)
    particles[~np.isin(np.arange(nodes), parent)] = 1
    for i in range(nodes - 1, 0, -1):
        particles[parent[i]] += particles[i]
    extent = max(float(np.ptp(points, axis=0).max()), 1e-3)
    radius = 0.02 * extent * np.sqrt(particles / particles[0])
    stepped = rng.random(nodes) < step_in_thickness
    radius = np.where(stepped, radius * rng.uniform(0.05, 3.0, nodes), radius)
    level = np.zeros(nodes, np.int32)
    taken = np.zeros(nodes, bool)
    for i in sorted(range(1, nodes), key=lambda k: (parent[k], -radius[k], k)):
        level[i] = level[parent[i]] + taken[parent[i]]
        taken[parent[i]] = True
    return Skeleton(
        parent=parent.astype(np.int32),
        points=points.astype(np.float32),
        radius=radius.astype(np.float32),
        particles=particles,
        level=level,
        twig=(particles == 1) & (rng.random(nodes) < 0.5),
    )


def skeleton_of_stems(stems: list[list[list[float]]]) -> Skeleton:
    """Joins stems, polylines of [x, y, z, radius] each of which begins on an earlier one, into a skeleton."""
    points = [np.array(stems[0][0][:3])]
    radius, parent = [stems[0][0][3]], [-1]
    for number, stem in enumerate(stems):
        line = np.array(stem)
        near = np.linalg.norm(np.array(points) - line[0, :3], axis=1)
        at = int(near.argmin())
        begin = 1 if number == 0 or near[at] < 0.05 else 0
        for node in line[begin:]:
            parent.append(at)
            points.append(node[:3])
            radius.append(node[3])
            at = len(points) - 1
    made = skeleton_of(np.array(parent), np.array(points), np.random.default_rng(0))
    return Skeleton(
        parent=made.parent,
        points=made.points,
        radius=np.array(radius, np.float32),
        particles=made.particles,
        level=made.level,
        twig=np.zeros(len(parent), bool),
    )
