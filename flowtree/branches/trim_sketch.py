"""A drawn twig with as few nodes as show its shape."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flowtree.geometry.parent_array import levels, main_child
from flowtree.model.attractor import AttractorGraph

_SHORTEST = 0.06  # of the twig's length: shorter side shoots are slips of the pen
_MOST_SIDES = 12
_NEAR = 0.04  # of the twig's length: forks nearer than this share a node
_PARTS, _SIDE_PARTS = 3, 2  # a shoot's segments at least; a side shoot's, if it is at least so long:
_LONG = 0.3

_Array = NDArray[np.float64]


@dataclass(frozen=True)
class TwigSketch:
    """A twig in the plane, from (0, 0) to its tip at (0, 1).

    Attributes:
        parent: (n,) int32, -1 for what grows from the branch itself; ``parent[i] < i``.
        points: (n, 2) float64; the branch is at (0, 0).
        begins: (n,) bool, the first node of each side shoot.
        shoot: (k,) int32, the nodes from the branch to the tip.
    """

    parent: NDArray[np.int32]
    points: NDArray[np.float64]
    begins: NDArray[np.bool_]
    shoot: NDArray[np.int32]


def trim_sketch(drawn: AttractorGraph) -> TwigSketch:
    """Straightens a drawn twig to unit length and keeps its forks, its tips and a few bends.

    The shoot leads to the tip that is farthest along the lines. Side shoots that are very short are dropped;
    of the others the 12 longest stay. Side shoots that leave the shoot where it begins grow from the branch.
    """
    points = drawn.points.astype(np.float64)
    step = np.linalg.norm(points - points[np.maximum(drawn.parent, 0)], axis=1)
    ahead = np.zeros(len(points))  # the way from a node's parent to the farthest tip behind it
    for nodes in reversed(levels(drawn.parent)):
        ahead[nodes] += step[nodes]
        inner = nodes[drawn.parent[nodes] >= 0]
        np.maximum.at(ahead, drawn.parent[inner], ahead[inner])
    child = main_child(drawn.parent, ahead)
    chains = _chains(drawn.parent, child, ahead, _SHORTEST * float(ahead[0]))
    forks = {int(drawn.parent[chain[0]]) for chain in chains[1:]}

    parent: list[int] = []
    places: list[_Array] = []
    begins: list[bool] = []
    node_of = {0: -1}  # the branch itself
    shoot: list[int] = []
    for number, chain in enumerate(chains):
        above = node_of[0 if number == 0 else int(drawn.parent[chain[0]])]
        for k, (node, drawn_nodes) in enumerate(_kept(chain, step, forks, float(ahead[0]), number == 0)):
            parent.append(above)
            places.append(points[node])
            begins.append(number > 0 and k == 0)
            above = len(parent) - 1
            node_of.update(dict.fromkeys(drawn_nodes, above))
            if number == 0:
                shoot.append(above)
    tip = places[shoot[-1]]
    if float(np.hypot(*tip)) < 1e-6 * float(ahead[0]):  # a ring: its end is where it begins
        tip = max(places, key=lambda place: float(np.hypot(*place)))
    turn = np.array([[tip[1], tip[0]], [-tip[0], tip[1]]]) / float(tip @ tip)
    return TwigSketch(
        parent=np.array(parent, np.int32),
        points=np.array(places) @ turn,
        begins=np.array(begins),
        shoot=np.array(shoot, np.int32),
    )


def _chains(
    parent: NDArray[np.int32], child: NDArray[np.int64], ahead: _Array, shortest: float
) -> list[list[int]]:
    """The nodes of the shoot behind the root and of the longest side shoots, parents before children."""
    side = [k for k in range(1, len(parent)) if child[parent[k]] != k and ahead[k] >= shortest]
    longest = sorted(side, key=lambda k: (-ahead[k], k))[:_MOST_SIDES]
    chains = []
    for first in [int(child[0]), *sorted(longest)]:
        chain = [first]
        while child[chain[-1]] >= 0:
            chain.append(int(child[chain[-1]]))
        chains.append(chain)
    held = {0}
    kept = []
    for chain in chains:
        if int(parent[chain[0]]) in held:
            kept.append(chain)
            held.update(chain)
    return kept


def _kept(
    chain: list[int], step: _Array, forks: set[int], whole: float, is_shoot: bool
) -> list[tuple[int, list[int]]]:
    """The nodes of a chain that stay, each with the drawn nodes that it stands for."""
    along = np.cumsum(step[chain])
    length = float(along[-1])
    parts = _PARTS if is_shoot else _SIDE_PARTS if length >= _LONG * whole else 1
    wanted = [float(along[k]) for k, node in enumerate(chain) if node in forks]
    chosen = [length]
    for place in wanted:
        if min(abs(place - other) for other in chosen) > _NEAR * whole:
            chosen.append(place)
    chosen.sort()
    filled: list[float] = []
    before = 0.0
    for place in chosen:
        more = int(np.ceil((place - before) / (length / parts) - 0.5))
        filled += [before + (place - before) * k / max(more, 1) for k in range(1, more)]
        filled.append(place)
        before = place
    index = np.unique(np.searchsorted(along, np.array(filled) - 1e-9 * whole).clip(0, len(chain) - 1))
    nearest = np.argmin(np.abs(along[:, None] - along[index]), axis=1)
    return [
        (chain[i], [chain[k] for k in np.flatnonzero(nearest == n)]) for n, i in enumerate(index.tolist())
    ]
