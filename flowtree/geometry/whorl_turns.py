"""Phyllotaxis: by which angles things turn around their axis."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray


def whorl_turns(order: NDArray[np.integer[Any]], whorl: int, divergence: float) -> NDArray[np.float64]:
    """Angles (n,) [degrees] around an axis of the things that leave it one after the other.

    Args:
        order: (n,) which they are along the axis, from 0.
        whorl: how many leave it at one place, evenly around it: 1 alternate, 2 opposite.
        divergence: from one place to the next [degrees].
    """
    place, member = np.divmod(order, whorl)
    return np.asarray(place * divergence + member * (360.0 / whorl))
