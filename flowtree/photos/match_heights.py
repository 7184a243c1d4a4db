"""Where foot and top of a tree lie that a photograph cuts off, from the other views of it."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flowtree.geometry.central_plane import PlaneView

#: Heights at which profiles are compared, from the foot to a tenth above the top.
LEVELS = (np.arange(106) + 0.5) / 96
_SAMPLES = 160  # rows of the photograph that are compared
_SIDE = 17  # foots and tops tried, each, in a round
_ROUNDS = 4
_CLOSER = 4.0  # by which a round's range is narrower than that before
_BLOCKS = 12  # stretches of a profile that differ independently: a twelfth of the height, a whorl or a clump
_LEAST_MISMATCH = 1e-4  # no two photographs are more alike
_USUAL = 0.05  # of what is seen of the tree: what a frame usually cuts off
_FARTHEST = 0.6  # of that: beyond, too little is seen to tell
_AROUND = 2.5  # deviations to either side of what is seen that are looked at
_LEAST_HEIGHT = 16.0  # [pixels]


@dataclass(frozen=True)
class RowDepths:
    """What a level picture holds, row by row.

    Attributes:
        rows: (k,) middles of the rows [pixels], growing.
        depths: (k,) optical depth, summed over the row [pixels].
    """

    rows: NDArray[np.float64]
    depths: NDArray[np.float64]


@dataclass(frozen=True)
class Guess:
    """What a view by itself says of the row of its foot or top.

    Attributes:
        row: where it is seen, or the row at which the frame cuts it off [pixels].
        spread: how far off that may be, one standard deviation [pixels]; 0 is exact.
        hidden: the frame cuts it off: it lies at ``row`` or beyond.
    """

    row: float
    spread: float = 0.0
    hidden: bool = False


@dataclass(frozen=True)
class HeightMatch:
    """Foot and top that agree best with another view.

    Attributes:
        foot: its row [pixels].
        top: its row [pixels].
        foot_deviation: [pixels], one standard deviation.
        top_deviation: [pixels], one standard deviation.
    """

    foot: float
    top: float
    foot_deviation: float
    top_deviation: float


def height_profile(seen: RowDepths, view: PlaneView) -> NDArray[np.float64]:
    """Optical depth at each of `LEVELS`, summed over the width of the tree [tree heights]."""
    height = view.height(seen.rows)
    known = np.isfinite(height)
    tall = height[known][::-1]
    depth = (seen.depths[known] / view.scale(height[known]))[::-1]
    return np.asarray(np.interp(LEVELS, tall, depth, left=0.0, right=0.0))


def match_heights(
    seen: RowDepths,
    profiles: Sequence[NDArray[np.float64]],
    view_of: Callable[[float, float], PlaneView],
    *,
    foot: Guess,
    top: Guess,
) -> HeightMatch:
    """Finds the rows of foot and top with which a view's row sums agree with those of other views.

    A level slice of a tree holds one amount of leaf and wood from wherever it is seen, so the sums of optical
    depth over the rows, in tree heights, are one function of the height for all views. Rows outside the
    picture count for nothing. Compared are square roots, in which clumps scatter alike where there is much
    and where there is little; how much they scatter is not known before, so the likelihood is a power of the
    mismatch. That a frame cuts off much is less common than that it cuts off little. The best of a grid of
    feet and tops is looked at ever closer.

    Args:
        seen: the view that is cut off.
        profiles: of other views, at `LEVELS`; their mean is taken.
        view_of: the view's geometry with its foot and top in given rows.
        foot: what the view itself shows of it.
        top: what the view itself shows of it.

    Returns: the best of all, and how far from it agreement is nearly as good.
    """
    mean = np.sqrt(np.mean(profiles, axis=0))
    pick = np.linspace(0, len(seen.rows) - 1, min(_SAMPLES, len(seen.rows))).round().astype(int)
    rows, depths = seen.rows[pick], seen.depths[pick]
    tall = foot.row - top.row
    limits = [_limits(foot, tall, 1.0), _limits(top, tall, -1.0)]

    def unlikelihood(low: float, high: float) -> float:
        view = view_of(low, high)
        height = view.height(rows)
        if low - high < _LEAST_HEIGHT or not np.isfinite(height).all():
            return math.inf
        there = np.sqrt(depths / view.scale(height))
        expected = np.interp(height, LEVELS, mean, left=0.0, right=0.0)
        shown = (height > 0.0) & (height < LEVELS[-1])
        # Outside the tree both are nothing: that agreement must not be bought with a smaller tree.
        weight = np.abs(np.gradient(height)) * np.where(shown, 1.0, there > 0.0)
        scale = float((weight * (there**2 + expected**2)).sum())
        mismatch = float((weight * (there - expected) ** 2).sum()) / max(scale, 1e-12)
        before = _unusual(foot, low, tall) + _unusual(top, high, tall)
        return _BLOCKS / 2 * math.log(max(mismatch, _LEAST_MISMATCH)) + before

    spans = limits
    best = (foot.row, top.row)
    costs: dict[tuple[float, float], float] = {}
    for _ in range(_ROUNDS):
        feet, tops = (np.unique(np.linspace(*span, _SIDE)) for span in spans)
        for low in feet:
            for high in tops:
                costs[low, high] = unlikelihood(float(low), float(high))
        best = min(costs, key=lambda pair: costs[pair])
        half = [(span[1] - span[0]) / 2 / _CLOSER for span in spans]
        spans = [
            (max(limit[0], at - reach), min(limit[1], at + reach))
            for at, reach, limit in zip(best, half, limits, strict=True)
        ]
    if math.isinf(costs[best]):  # too small a picture for any tree
        return HeightMatch(foot.row, top.row, tall, tall)
    deviations = _deviations(costs, best)
    return HeightMatch(float(best[0]), float(best[1]), *deviations)


def _limits(guess: Guess, tall: float, beyond: float) -> tuple[float, float]:
    """Rows that are looked at: beyond the frame, in the direction ``beyond``, or around what is seen."""
    if guess.hidden:
        low, high = sorted((guess.row, guess.row + beyond * _FARTHEST * tall))
        return low, high
    return guess.row - _AROUND * guess.spread, guess.row + _AROUND * guess.spread


def _unusual(guess: Guess, row: float, tall: float) -> float:
    """Minus the logarithm of how likely a row is before the views are compared."""
    away = abs(row - guess.row)
    if guess.hidden:
        return away / (_USUAL * tall)
    return (away / guess.spread) ** 2 / 2 if guess.spread > 0.0 else 0.0


def _deviations(costs: dict[tuple[float, float], float], best: tuple[float, float]) -> tuple[float, float]:
    """Deviations of foot and top: means over all that was tried, weighted by its likelihood."""
    pairs, cost = np.array(list(costs)), np.array(list(costs.values()))
    # What was tried lies closer together near the best: each stands for the area around it.
    away = np.abs(pairs - best) / np.maximum(np.ptp(pairs, axis=0), 1e-9)
    weight = np.exp(costs[best] - cost) * (np.hypot(away[:, 0], away[:, 1]) + 1e-3) ** 2
    spread = (weight[:, None] * (pairs - best) ** 2).sum(axis=0) / float(weight.sum())
    return math.sqrt(float(spread[0])), math.sqrt(float(spread[1]))
