"""Small twigs to choose from (Particle Flows, figure 6a)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class TwigShapes:
    """Twigs of unit length along +y, their upper side toward +z, that differ in their bends alone.

    Attributes:
        parent: (n,) int32, -1 for what grows from the branch; ``parent[i] < i``.
        points: (shapes, n, 3) float64; the branch itself is at the origin.
        thickness: (n,) float64, share of the twig's radius.
        shoot: (k,) int32, the nodes from the branch to the twig's tip.
    """

    parent: NDArray[np.int32]
    points: NDArray[np.float64]
    thickness: NDArray[np.float64]
    shoot: NDArray[np.int32]


def shape_twigs(
    count: int, *, side_twigs: int, angle: float, curl: float, random: np.random.Generator
) -> TwigShapes:
    """Curved shoots with side twigs in alternation to their left and right.

    Args:
        count: of the shapes.
        side_twigs: on each; 0 for a plain shoot.
        angle: between shoot and side twig [degrees].
        curl: how far a tip leaves the straight line, as a share of the length (standard deviation).
        random: of the bends.

    Returns: the shapes; their parents are alike, so that a tree's twigs can be built all at once.
    """
    way = np.array([0.36, 0.7, 1.0])
    bend = random.normal(0.0, curl, (count, 1, 2))
    shoot = np.empty((count, 3, 3))
    shoot[..., 1] = way
    shoot[..., [0, 2]] = bend * way[:, None] ** 2
    parent, thickness, points = [-1, 0, 1], [1.0, 0.8, 0.5], [shoot]
    for k in range(side_twigs):
        node = 2 * k // side_twigs
        turn = np.radians(angle * random.uniform(0.75, 1.2, count))
        length = ((1.0 - way[node]) * random.uniform(0.6, 1.0, count))[:, None]
        out = np.stack([np.sin(turn) * (-1) ** k, np.cos(turn), random.normal(0.0, 0.25, count)], axis=1)
        points.append((shoot[:, node] + length * out)[:, None])
        parent.append(node)
        thickness.append(0.5)
    return TwigShapes(
        parent=np.array(parent, np.int32),
        points=np.concatenate(points, axis=1),
        thickness=np.array(thickness),
        shoot=np.arange(3, dtype=np.int32),
    )
