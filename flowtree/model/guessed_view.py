"""How a tree may look from a side that no photograph shows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flowtree.model.camera import Camera


@dataclass(frozen=True)
class GuessedView:
    """A view of the density volume, where there is no matte.

    Attributes:
        alpha: (h, w) float32 in 0..1.
        camera: where it looks from.
        weight: what it counts beside 1 of a matte.
    """

    alpha: NDArray[np.float32]
    camera: Camera
    weight: float
