"""The true height of a crown that was photographed from near and below, less than it seems to have."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

_BODY = 0.97  # of a tree's optical depth lies below what is its body here
# Logarithm of a tree's height over its body's: mean and deviation over parallel projections and photographs
# of nineteen trees, from palm and aspen to spruce, oak and weeping willow.
_USUAL, _SPREAD = 0.115, 0.045
# Where in a crown its highest bough stands: of the crown's reach toward the viewer, one standard deviation.
_BOUGH = 1.0 / 3.0


def lower_top(
    depths: NDArray[np.float64], foot: float, top: float, *, reach: float, distance: float
) -> tuple[float, float]:
    """The row in which the tree would end if its highest bough stood over the foot.

    From below, a bough that reaches toward the viewer stands higher in a picture than the top over the axis:
    what is ``d`` nearer than the axis is seen ``D / (D - d)`` as far above the horizon, D being the distance.
    One bough is enough to make the whole tree look taller than it is, and too thin for its height. The body
    of the tree is seen where it is, for as much of it is behind the axis as before it; trees end a usual way
    above it. That way and the reach of a bough are both known only roughly, and a height that is unusual for
    its body is shared out between them.

    Args:
        depths: (h,) optical depth of each row of the picture, summed.
        foot: row of the foot [pixels].
        top: row in which the tree is seen to end [pixels].
        reach: half of the width of the crown's upper part [tree heights].
        distance: of the eye from the axis [tree heights]; infinite changes nothing.

    Returns: (row, deviation) [pixels], the row ``top`` or below.
    """
    rows = slice(max(0, math.floor(top)), min(len(depths), math.ceil(foot)))
    above = np.cumsum(depths[rows])
    if math.isinf(distance) or not len(above) or above[-1] <= 0.0:
        return top, 0.0
    body = foot - rows.start - float(np.interp((1.0 - _BODY) * above[-1], above, np.arange(len(above)) + 1.0))
    tall = foot - top
    bough = _BOUGH * -math.log1p(-min(reach / distance, 0.5))
    share = bough**2 / (bough**2 + _SPREAD**2)
    raised = share * max(0.0, math.log(tall / max(body, 1.0)) - _USUAL)
    return foot - tall * math.exp(-raised), tall * bough * math.sqrt(1.0 - share)
