"""Grows a broadleaf by space colonisation (Runions, Lane and Prusinkiewicz 2007), without photographs.

It has nothing in common with the particle flow: what `demo_pair` photographs must not favour the method.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from flowtree.model.skeleton import Skeleton

_STEP = 0.13  # [m] a shoot grows in a round
_REACH = 2.4  # [m] within which a point draws a shoot
_KILL = 0.22  # [m] within which a point is reached
_FORK = 2.5  # [m] height of the clear stem
_LEADER = 5.6  # [m] up to which the stem goes on through the crown
_TIP_RADIUS = 0.0045  # [m]
_PIPE = 1.9  # r ** _PIPE adds up at forks


def colonise_space(seed: int, *, height: float = 11.0) -> Skeleton:
    """Grows limbs to the lobes of a crown, and from them shoots to all points in the lobes; [m]."""
    rng = np.random.default_rng(seed)
    lobes = _place_lobes(rng, height)
    points, parent, growing = _grow_limbs(rng, lobes)
    targets = np.concatenate([_scatter(rng, middle, size) for middle, size in lobes])
    heading = {node: points[node] - points[parent[node]] for node in growing}
    for _ in range(400):
        tree = cKDTree(np.array([points[node] for node in growing]))
        far, near = tree.query(targets)
        targets, far, near = targets[far > _KILL], far[far > _KILL], near[far > _KILL]
        near = near[far < _REACH]
        if not len(near):
            break
        pull = targets[far < _REACH] - tree.data[near]
        pull /= np.linalg.norm(pull, axis=1, keepdims=True)
        total = np.zeros((len(tree.data), 3))
        np.add.at(total, near, pull)
        before = len(points)
        for k in np.unique(near):
            node = growing[k]
            way = total[k] / np.linalg.norm(total[k])
            way += 0.45 * heading[node] / np.linalg.norm(heading[node]) + rng.normal(0, 0.16, 3)
            way[1] += 0.12
            new = points[node] + _STEP * way / np.linalg.norm(way)
            if tree.query(new)[0] > 0.3 * _STEP:
                heading[len(points)] = way
                points.append(new)
                parent.append(node)
        growing.extend(range(before, len(points)))
        if len(points) == before:
            break
    return _finish(np.array(points), np.array(parent))


def _place_lobes(
    rng: np.random.Generator, height: float
) -> list[tuple[NDArray[np.float64], NDArray[np.float64]]]:
    """Middles and half axes of lobes with gaps between them: the open crown of a tree that stands alone."""
    lobes = [(np.array([0.15, 0.83 * height, 0.0]), np.array([1.6, 1.7, 1.6]))]
    for k in range(11):
        turn = 2.399963 * k + rng.normal(0, 0.2)
        level = 0.37 + 0.40 * (k / 10) + rng.normal(0, 0.02)
        out = (2.9 - 4.6 * max(0.0, level - 0.5)) * rng.uniform(0.85, 1.1)
        middle = np.array([out * np.cos(turn), level * height, out * np.sin(turn)])
        lobes.append((middle, np.array([1.4, 1.0, 1.4]) * rng.uniform(0.85, 1.15)))
    return lobes


def _scatter(
    rng: np.random.Generator, middle: NDArray[np.float64], size: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Points in an ellipsoid, a little denser outside."""
    way = rng.normal(size=(900, 3))
    way *= rng.random((900, 1)) ** (1 / 3.4) / np.linalg.norm(way, axis=1, keepdims=True)
    return middle + way * size


def _grow_limbs(
    rng: np.random.Generator,
    lobes: list[tuple[NDArray[np.float64], NDArray[np.float64]]],
) -> tuple[list[NDArray[np.float64]], list[int], list[int]]:
    """A stem that bends a little, and a limb to each lobe; their nodes, parents, and those that grow on."""
    stem = int(_LEADER / _STEP)
    share = np.linspace(0, 1, stem)
    aside = 0.22 * np.sin(4.3 * share + 0.4) * share, 0.20 * np.sin(5.1 * share + 2.0) * share
    points = list(np.stack([aside[0], _STEP * np.arange(stem), aside[1]], axis=1))
    parent = list(range(-1, stem - 1))
    growing: list[int] = []
    for middle, _ in lobes:
        out = float(np.hypot(middle[0], middle[2]))
        fork = int(np.clip((middle[1] - 0.8 * out) / _STEP, _FORK / _STEP, stem - 1))
        start = points[fork]
        bend = start + (middle - start) * np.array([0.55, 0.32, 0.55]) + rng.normal(0, 0.18, 3)
        sway = rng.normal(0, 0.07, 3)
        count = max(2, int(np.linalg.norm(middle - start) / _STEP))
        node = fork
        for t in np.linspace(0, 1, count + 1)[1:]:
            points.append(
                (1 - t) ** 2 * start + 2 * t * (1 - t) * bend + t**2 * middle + sway * np.sin(9 * t) * t
            )
            parent.append(node)
            node = len(points) - 1
            if t > 0.5:
                growing.append(node)
    return points, parent, growing


def _finish(points: NDArray[np.float64], parent: NDArray[np.intp]) -> Skeleton:
    """Radii by the pipe model, smoothed branches, branching orders."""
    count = len(parent)
    children = np.bincount(parent[1:], minlength=count)
    for _ in range(3):  # a fork's children leave more smoothly when every node moves toward its neighbours
        middle = points.copy()
        np.add.at(middle, parent[1:], points[1:])
        middle[1:] += points[parent[1:]]
        middle /= (1 + children + (np.arange(count) > 0))[:, None]
        kept = (children == 0) | (np.arange(count) == 0)
        points = np.where(kept[:, None], points, 0.5 * points + 0.5 * middle)
    area = np.where(children == 0, _TIP_RADIUS**_PIPE, 0.0)
    passing = np.where(children == 0, 1, 0)
    for node in range(count - 1, 0, -1):
        area[node] += 0.02 * _TIP_RADIUS**_PIPE  # a shoot without forks tapers too
        area[parent[node]] += area[node]
        passing[parent[node]] += passing[node]
    level = np.zeros(count, np.int32)
    thickest = np.full(count, -1)
    for node in range(1, count):
        if thickest[parent[node]] < 0 or area[node] > area[thickest[parent[node]]]:
            thickest[parent[node]] = node
    for node in range(1, count):
        level[node] = level[parent[node]] + (thickest[parent[node]] != node)
    return Skeleton(
        parent=parent.astype(np.int32),
        points=(points - points[0]).astype(np.float32),
        radius=(area ** (1 / _PIPE)).astype(np.float32),
        particles=passing.astype(np.int32),
        level=level,
        twig=np.zeros(count, bool),
    )
