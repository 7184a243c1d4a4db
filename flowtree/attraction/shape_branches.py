"""From a staircase of cells to branches."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flowtree.attraction.growing_tree import GrowingTree
from flowtree.geometry.polylines import arc_lengths, resample_polyline, smooth_polyline

_SMOOTH = 0.018  # of the height: sigma of the smoothing along a branch
_SPACING = 0.015  # of the height: distance of the nodes
_LEAST_SPACING = 0.5  # cells: below that there is nothing to sample
_WIDEST = 58.0  # [degrees] at a fork; wider ones are bent
_BENT_TO = 45.0  # [degrees]
_KINK = 0.025  # of the height: a fork's angle is also taken this near to it
_BEND = 0.09  # of the height: how far from a fork a branch is bent
_SEEN = 0.7  # share of that way, from where it leaves its carrier, on which a limb must show to stay

_Array = NDArray[np.float64]


@dataclass
class _Branch:
    nodes: list[int]  # of the growing tree; the first lies on the branch that carries this one
    carrier: int  # its number, -1 for the trunk


def shape_branches(
    tree: GrowingTree, tall: float, lowest: int = 0, shown: NDArray[np.bool_] | None = None
) -> tuple[NDArray[np.int32], _Array]:
    """Smooths and resamples a tree of grid paths; drawn nodes, tips and the root stay.

    Each branch runs on through its forks into its heaviest child, so a fork makes no kink in it. Side
    branches that leave at more than about sixty degrees start lower on their carrier and curve outwards, as
    most real ones do; but for those that the picture shows to leave as they do.

    Args:
        tree: what the paths left.
        tall: the tree's height [cells].
        lowest: no fork moves below this node.
        shown: (h, w) cells of limbs that stand free in the matte; None for none.

    Returns:
        parent: (n,) int32, ``parent[i] < i``.
        points: (n, 2) [cells].
    """
    position = np.array(tree.points)
    parent = np.array(tree.parent, np.int64)
    drawn = np.array(tree.drawn)
    free = np.zeros(len(parent), np.bool_)
    if shown is not None:
        free = np.array([bool(shown[tree.cell_of(point)]) for point in tree.points])
    branches = _split(parent, position)
    on_carrier: dict[int, tuple[int, int]] = {}
    for number, branch in enumerate(branches):
        _smooth_runs(branch.nodes, position, drawn, _SMOOTH * tall)
        if branch.carrier >= 0 and not _leaves_in_sight(branch.nodes, free, position, tall):
            _relax_fork(branch, branches[branch.carrier], position, drawn, tall, lowest)
        for place, node in enumerate(branch.nodes[1:], 1):
            on_carrier[node] = (number, place)
    return _assemble(branches, position, drawn, max(_SPACING * tall, _LEAST_SPACING))


def _split(parent: NDArray[np.int64], position: _Array) -> list[_Branch]:
    """Branches from the root on, carriers first; each follows the child with the greatest length above it."""
    count = len(parent)
    above = np.zeros(count)
    for node in range(count - 1, 0, -1):
        above[parent[node]] += above[node] + float(np.linalg.norm(position[node] - position[parent[node]]))
    children: list[list[int]] = [[] for _ in range(count)]
    for node in range(1, count):
        children[parent[node]].append(node)
    branches: list[_Branch] = []
    waiting = [(0, -1, -1)]
    while waiting:
        first, fork, carrier = waiting.pop(0)
        nodes = [first] if fork < 0 else [fork, first]
        number = len(branches)
        branches.append(_Branch(nodes, carrier))
        node = first
        while children[node]:
            heavy = max(children[node], key=lambda child: (above[child], -child))
            waiting.extend((child, node, number) for child in children[node] if child != heavy)
            nodes.append(heavy)
            node = heavy
    return branches


def _smooth_runs(nodes: list[int], position: _Array, drawn: NDArray[np.bool_], sigma: float) -> None:
    """Smooths a branch between its drawn nodes, in place."""
    stops = [0, *(k for k in range(1, len(nodes) - 1) if drawn[nodes[k]]), len(nodes) - 1]
    for start, end in itertools.pairwise(stops):
        if end - start > 1:
            run = nodes[start : end + 1]
            position[run] = smooth_polyline(position[run], sigma)


def _leaves_in_sight(nodes: list[int], free: NDArray[np.bool_], position: _Array, tall: float) -> bool:
    """Whether the picture shows how a branch leaves its carrier, behind whose edge it comes in sight."""
    along = arc_lengths(position[nodes])
    begin = free[[node for node, way in zip(nodes, along, strict=True) if way <= _BEND * tall]]
    behind = int(begin.argmax())
    return bool(begin.any()) and 2 * behind <= len(begin) and float(begin[behind:].mean()) >= _SEEN


def _relax_fork(
    branch: _Branch,
    carrier: _Branch,
    position: _Array,
    drawn: NDArray[np.bool_],
    tall: float,
    lowest: int,
) -> None:
    """Bends the beginning of a branch that leaves its carrier too flatly, in place."""
    line = position[branch.nodes]
    along = arc_lengths(line)
    bend = int(np.searchsorted(along, min(0.5 * along[-1], _BEND * tall)))
    fork = carrier.nodes.index(branch.nodes[0])
    if bend < 2 or fork == 0 or drawn[branch.nodes[1 : bend + 1]].any():
        return
    reach = max(2, round(0.02 * tall))
    low, high = carrier.nodes[max(0, fork - reach)], carrier.nodes[min(len(carrier.nodes) - 1, fork + reach)]
    onward = position[high] - position[low]
    size = float(np.linalg.norm(onward))
    if size == 0.0:
        return
    onward = onward / size
    kink = min(bend, max(2, int(np.searchsorted(along, _KINK * tall))))
    if max(_angle(line[kink] - line[0], onward), _angle(line[bend] - line[0], onward)) <= _WIDEST:
        return
    out = line[bend] - line[0]
    forward = float(out @ onward)
    sideways = float(np.linalg.norm(out - forward * onward))
    slide = sideways / np.tan(np.radians(_BENT_TO)) - forward
    slide = min(max(slide, _KINK * tall), _BEND * tall)
    back = np.cumsum(np.linalg.norm(np.diff(position[carrier.nodes[fork::-1]], axis=0), axis=1))
    steps = int(np.searchsorted(back, slide))
    floor = carrier.nodes.index(lowest) if lowest in carrier.nodes[: fork + 1] else 0
    lower = max(floor, 1 if fork > 1 else 0, fork - steps)
    branch.nodes[0] = carrier.nodes[lower]
    start = position[branch.nodes[0]]
    chord = line[bend] - start
    length = float(np.linalg.norm(chord))
    tail = line[min(len(line) - 1, bend + reach)] - line[bend - 1]
    leave = 0.5 * (onward + chord / max(length, 1e-9))
    leave *= length / max(float(np.linalg.norm(leave)), 1e-9)
    arrive = tail * (length / max(float(np.linalg.norm(tail)), 1e-9))
    position[branch.nodes[1 : bend + 1]] = _hermite(start, line[bend], leave, arrive, bend)[1:]


def _angle(direction: _Array, axis: _Array) -> float:
    """Between a direction and a unit axis [degrees]."""
    forward = float(direction @ axis)
    return float(np.degrees(np.arctan2(np.linalg.norm(direction - forward * axis), forward)))


def _hermite(start: _Array, end: _Array, leave: _Array, arrive: _Array, count: int) -> _Array:
    """Points (count + 1, 2) of the cubic with these ends and end derivatives."""
    t = np.linspace(0.0, 1.0, count + 1)[:, None]
    return np.asarray(
        (2 * t**3 - 3 * t**2 + 1) * start
        + (t**3 - 2 * t**2 + t) * leave
        + (3 * t**2 - 2 * t**3) * end
        + (t**3 - t**2) * arrive
    )


def _assemble(
    branches: list[_Branch], position: _Array, drawn: NDArray[np.bool_], spacing: float
) -> tuple[NDArray[np.int32], _Array]:
    """The tree with evenly spaced nodes; forks, tips and drawn nodes are kept."""
    forks = {branch.nodes[0] for branch in branches}
    new = {branches[0].nodes[0]: 0}
    parent, points = [-1], [position[branches[0].nodes[0]]]
    for branch in branches:
        nodes = branch.nodes
        last = len(nodes) - 1
        stops = [k for k, node in enumerate(nodes) if k in (0, last) or node in forks or drawn[node]]
        at = new[nodes[0]]
        for start, end in itertools.pairwise(stops):
            run = position[nodes[start : end + 1]]
            # Drawn nodes lie as densely as they should: nothing is to be resampled between neighbours.
            near = len(run) == 2 and float(np.hypot(*(run[1] - run[0]))) <= spacing
            for point in run[1:] if near else resample_polyline(run, spacing)[1:]:
                parent.append(at)
                points.append(point)
                at = len(points) - 1
            points[at] = position[nodes[end]]
            new[nodes[end]] = at
    return np.array(parent, np.int32), np.array(points)
