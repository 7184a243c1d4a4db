"""How much of a crown is above a photograph whose upper edge cuts it off."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

_EDGE = 0.03  # of the picture's height: the rows that say how wide the crown is at the edge
_STRAY = 0.02  # of what is seen there, on either side: a twig that stands apart
_DOME = 0.5  # widths: half a ball


def crown_above(alpha: NDArray[np.float32]) -> float:
    """Rows [pixels] by which a crown that touches the upper edge goes on: half a ball over its width there.

    Args:
        alpha: (h, w) in 0..1.
    """
    across = np.cumsum(alpha[: max(1, round(_EDGE * len(alpha)))].sum(axis=0, dtype=np.float64))
    low, high = np.searchsorted(across, (_STRAY * across[-1], (1.0 - _STRAY) * across[-1]))
    return _DOME * float(high - low + 1)
