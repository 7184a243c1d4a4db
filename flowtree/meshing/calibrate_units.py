"""How long units are, so that neighbours do not crowd each other (Manifold Ramifications, 5)."""

from __future__ import annotations

import numpy as np

from flowtree.meshing.branch_axes import Floats

_STEPS = np.linspace(0.0, 1.0, 17)


def calibrate_units(
    gap: Floats, twist: Floats, long: tuple[Floats, Floats], short: tuple[Floats, Floats], reach: Floats
) -> tuple[Floats, Floats, Floats]:
    """Moves the boundaries that two neighbours turn to each other (equations 7 to 9).

    The end boundary of the first and the start boundary of the second are moved toward their units' middles
    by one share of what each may lose (equation 7's constraint); the share that minimises RU + RC is found
    among 17. RU (equation 8) is four times the cosine distance between the ways from Q to a corner before and
    after. RC (equation 9) grows from 0 at a gap of ``reach``, the paper's T, to the cosine distance of the
    boundaries, read here as 1 plus it: units that lie close are bad even without a twist. Both are taken as
    energies rather than as increments, and a cosine distance is 1 minus the cosine.

    Args:
        gap: (n,) [m], between the boundaries before they move; below 0 the units overlap.
        twist: (n,) [radians], by which the boundaries are turned against each other.
        long: (n,) and (n,) [m], of the two units, from Q to the boundary before.
        short: the same after the longest move.
        reach: (n,) [m].

    Returns: the moves (n,) and (n,) [m], and what is left of RU + RC (n,); infinite where they overlap still.
    """
    give = [np.maximum(a - b, 0.0)[:, None] * _STEPS for a, b in zip(long, short, strict=True)]
    distance = gap[:, None] + give[0] + give[1]
    bend = np.zeros_like(distance)
    for whole, moved in zip(long, give, strict=True):
        # Q is a radius away from the axis and half a boundary's edge from the corner: a cube's face.
        flat = 0.5 * np.square(reach)[:, None]
        before, after = np.square(whole)[:, None] + flat, np.square(whole[:, None] - moved) + flat
        cosine = (before + after - np.square(moved)) / (2.0 * np.sqrt(before * after))
        bend += 4.0 * (1.0 - cosine)
    close = np.maximum(1.0 - distance / reach[:, None], 0.0) * (2.0 - np.cos(2.0 * twist))[:, None]
    total = np.where(distance > 0.0, bend + close, np.inf)
    # Where they overlap whatever is done, the longest move is still the best.
    best = np.where(np.isinf(total).all(axis=1), len(_STEPS) - 1, total.argmin(axis=1))
    row = np.arange(len(gap))
    return give[0][row, best], give[1][row, best], total[row, best]
