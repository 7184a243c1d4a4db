"""Livewire: minimal paths from the seeds to the target."""

from __future__ import annotations

import itertools

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage
from skimage.graph import MCP_Geometric

from flowtree.attraction.growing_tree import GrowingTree

_ROUNDS = 9  # Dijkstra searches at most
_KEEP_OFF = 1.6  # how much dearer it is to run close beside a chosen path
_LIMB_MERGING = 0.65  # of the merging: how much the main limbs are drawn to each other
_BACKWARD = -0.6  # cosine of the angle at its join from which a short branch grows backwards
_SHORT = 5.0  # times the shortest length: what counts as short
_BESIDE = 0.022  # of the height: what counts as close beside


def grow_paths(
    tree: GrowingTree,
    cost: NDArray[np.float64],
    seeds: NDArray[np.intp],
    *,
    target: tuple[int, int],
    tall: float,
    limbs: int,
    merging: float,
    shortest: float = 0.0,
) -> None:
    """Joins every seed to the tree by its cheapest path to the target (Particle Flows, section 4).

    One Dijkstra from the target out to the seeds; walking back from each seed, the paths merge by
    themselves. Beyond the paper it is repeated for growing groups of seeds: cells that a path has taken
    become cheaper by ``merging`` and their neighbourhood dearer. So later paths join earlier ones instead of
    running beside them; and as a path over a plain that may use a line at the share m of its price leaves it
    at the angle arccos(m) (refraction), 0.4 makes forks of about 50 degrees.

    Args:
        tree: gets the paths.
        cost: (h, w) per cell.
        seeds: (k, 2) (row, column), most important first.
        target: (row, column).
        tall: the tree's height [cells].
        limbs: how many of the first seeds are searched one by one: they become trunk and main limbs.
        merging: 0..0.9.
        shortest: of the tree's height: a path that is shorter where it joins the tree is left out.
    """
    for group in _groups(len(seeds), limbs):
        taken = tree.node_at >= 0
        apart = ndimage.distance_transform_edt(~taken) / tall
        price = cost * (1.0 + _KEEP_OFF * np.exp(-((apart / _BESIDE) ** 2)))
        # The first few take less heed of each other: limbs fork at smaller angles than the branches on them.
        share = merging if group.start >= limbs else _LIMB_MERGING * merging
        price[taken] = cost[taken] * (1.0 - share)
        waiting = [(int(row), int(column)) for row, column in seeds[group] if not taken[row, column]]
        if not waiting:
            continue
        search = MCP_Geometric(price)
        search.find_costs([target], waiting)  # ends at the last seed: what lies farther is never looked at
        for seed in waiting:
            if tree.node_at[seed] < 0:
                path = search.traceback(seed)
                if _grows(tree, path, shortest * tall):
                    tree.add_path(path)


def _grows(tree: GrowingTree, path: list[tuple[int, int]], shortest: float) -> bool:
    """Whether a path makes a branch: not just a stub, and no short hook back along its carrier."""
    free = next((k for k, cell in enumerate(path[::-1]) if tree.node_at[cell] >= 0), len(path))
    if free < shortest or free == len(path):
        return free >= shortest
    if free > _SHORT * shortest:
        return True
    join = int(tree.node_at[path[-1 - free]])
    below = join
    for _ in range(max(3, round(shortest))):
        below = max(tree.parent[below], 0)
    onward = tree.points[join] - tree.points[below]
    out = np.array(path[-1], np.float64)[::-1] + 0.5 - tree.points[join]
    size = float(np.linalg.norm(onward) * np.linalg.norm(out))
    return size == 0.0 or float(onward @ out) >= _BACKWARD * size


def _groups(count: int, limbs: int) -> list[slice]:
    """The seeds in groups: the limbs one by one, then growing groups."""
    bounds = [*range(min(limbs, count) + 1)]
    rest = max(1, _ROUNDS - limbs)
    while bounds[-1] < count:
        left = count - bounds[-1]
        bounds.append(bounds[-1] + max(1, -(-left // (2 * rest)) if rest > 1 else left))
        rest -= 1
    return [slice(a, b) for a, b in itertools.pairwise(bounds)]
