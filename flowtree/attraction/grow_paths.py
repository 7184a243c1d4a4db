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
) -> None:
    """Joins every seed to the tree by its cheapest path to the target (Particle Flows, section 4).

    One Dijkstra from the target over the whole grid; walking back from each seed, the paths merge by
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
    """
    for group in _groups(len(seeds), limbs):
        taken = tree.node_at >= 0
        apart = ndimage.distance_transform_edt(~taken) / tall
        price = cost * (1.0 + _KEEP_OFF * np.exp(-((apart / _BESIDE) ** 2)))
        price[taken] = cost[taken] * (1.0 - merging)
        search = MCP_Geometric(price)
        search.find_costs([target])
        for seed in seeds[group]:
            if tree.node_at[tuple(seed)] < 0:
                tree.add_path(search.traceback(tuple(seed)))


def _groups(count: int, limbs: int) -> list[slice]:
    """The seeds in groups: the limbs one by one, then growing groups."""
    bounds = [*range(min(limbs, count) + 1)]
    rest = max(1, _ROUNDS - limbs)
    while bounds[-1] < count:
        left = count - bounds[-1]
        bounds.append(bounds[-1] + max(1, -(-left // (2 * rest)) if rest > 1 else left))
        rest -= 1
    return [slice(a, b) for a, b in itertools.pairwise(bounds)]
