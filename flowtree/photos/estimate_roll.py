"""By how much a photograph is turned, from the lean of the trunk in it."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

_SOLID = 0.5  # alpha inside the trunk
_FORKED = 1.35  # a run of pixels this much wider than the trunk is no trunk any more
_SHORTEST = 0.05  # of the tree's height: less of a trunk shows no direction
_HIGHEST = 0.6  # of the tree's height: what leads on above is a leader, not a trunk
_FLARE = 0.01  # of the tree's height: roots widen the trunk below
# How photographs and trees stand, in degrees: hands turn a camera by a few; most trunks are plumb to about
# one, measured over a fifth of the tree's height or more, and one in ten leans for good.
_CAMERA, _PLUMB, _PLUMB_OVER, _LEANING, _LEANERS = 3.0, 1.0, 0.2, 10.0, 0.1


def estimate_roll(
    alpha: NDArray[np.float32], foot: tuple[float, float], tall: float
) -> tuple[float, float] | None:
    """The photograph's roll, as far as the lean of the trunk speaks of it.

    A trunk that leans in the picture stands so, or the camera was turned: the picture alone cannot tell. Both
    are weighed by how common they are, with a heavy tail for leaning trees: of a slight lean most is taken
    for roll, of a strong one almost nothing. A short or crooked trunk says less.

    Args:
        alpha: (h, w) in 0..1.
        foot: (x, y) [pixels], where the trunk is seen to begin.
        tall: the tree's height [pixels].

    Returns: (roll, deviation) [degrees], positive where the picture's verticals lean to the right; None where
        no trunk is seen.
    """
    trunk = _follow_trunk(alpha, foot, tall)
    if trunk is None:
        return None
    rows, middles = trunk
    length = float(np.ptp(rows)) + 1.0
    slope, across = np.polyfit(rows, middles, 1)
    lean = math.degrees(math.atan(-float(slope)))
    wobble = float((middles - slope * rows - across).std())
    # The residuals of a bent trunk hang together: the worst case of a straight line through them.
    bend = math.degrees(math.atan(math.sqrt(12.0) * wobble / length))
    own = math.hypot(_PLUMB * math.sqrt(max(1.0, _PLUMB_OVER * tall / length)), bend)
    return _weigh(lean, own)


def _weigh(lean: float, own: float) -> tuple[float, float]:
    """Mean and deviation of the roll, given the lean in the picture and how plumb the trunk is by itself."""
    chance, mean, variance = [], [], []
    for share, spread in ((1.0 - _LEANERS, own), (_LEANERS, math.hypot(own, _LEANING))):
        total = _CAMERA**2 + spread**2
        chance.append(share * math.exp(-(lean**2) / (2 * total)) / math.sqrt(total))
        mean.append(lean * _CAMERA**2 / total)
        variance.append(_CAMERA**2 * spread**2 / total)
    weight = np.array(chance) / sum(chance)
    roll = float(weight @ mean)
    return roll, math.sqrt(float(weight @ (np.array(variance) + np.square(mean))) - roll**2)


def _follow_trunk(
    alpha: NDArray[np.float32], foot: tuple[float, float], tall: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]] | None:
    """Rows and middles [pixels] of the trunk, from its foot to where it forks."""
    rows, columns = alpha.shape
    start = int(min(foot[1], rows)) - 1 - round(_FLARE * tall)
    at = foot[0] - 0.5
    reach = max(2, round(0.01 * tall))
    widths: list[int] = []
    middles: list[float] = []
    for row in range(start, max(-1, start - round(_HIGHEST * tall)), -1):
        solid = alpha[row] > _SOLID
        near = np.flatnonzero(solid[max(0, round(at) - reach) : round(at) + reach + 1])
        if not len(near):
            break
        column = max(0, round(at) - reach) + int(near[np.abs(near - reach).argmin()])
        gaps = np.flatnonzero(~solid)
        right = int(np.searchsorted(gaps, column))
        low = int(gaps[right - 1]) + 1 if right else 0
        high = int(gaps[right]) if right < len(gaps) else columns
        base = widths[: max(4, round(0.03 * tall))]
        if len(widths) >= 4 and high - low > _FORKED * float(np.median(base)):
            break
        widths.append(high - low)
        middles.append((low + high) / 2)
        at = middles[-1] - 0.5
    if len(middles) < max(8, _SHORTEST * tall):
        return None
    return start + 0.5 - np.arange(len(middles), dtype=np.float64), np.array(middles, np.float64)
