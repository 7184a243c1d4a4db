"""A photograph as the stages see it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Photo:
    """One photograph, upright, at the working resolution.

    Attributes:
        name: the file's name, for messages and the report.
        rgb: (h, w, 3) uint8, sRGB, row 0 on top.
        alpha: (h, w) float32 in 0..1 where the file had an alpha channel, else None.
        scale: working pixels per pixel of the upright file (1 when nothing was scaled).
        focal_length: [working pixels] as the file says it, else None.
    """

    name: str
    rgb: NDArray[np.uint8]
    alpha: NDArray[np.float32] | None = None
    scale: float = 1.0
    focal_length: float | None = None
