"""Painted edits: what a person adds to, erases from or redirects in one view."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class PaintedEdit:
    """Edits of one view, in the plane of its working picture (Particle Flows, sections 1 and 9).

    Attributes:
        add: (h, w) float32 in 0..1, density painted in, as alpha; None for nothing.
        erase: (h, w) float32 in 0..1, the share of alpha taken away; None for nothing.
        directions: polylines (k, 2) float32 [pixels]; particles near one flow along it, from its first point
            to its last.
        reach: how far from a direction stroke its influence goes [pixels], one number a stroke.
    """

    add: NDArray[np.float32] | None = None
    erase: NDArray[np.float32] | None = None
    directions: tuple[NDArray[np.float32], ...] = field(default=())
    reach: tuple[float, ...] = field(default=())
