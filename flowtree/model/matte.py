"""An alpha matte: how much of each pixel is tree."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Matte:
    """The tree of one photograph, cut out.

    Attributes:
        alpha: (h, w) float32 in 0..1, the density estimate of this view (Particle Flows, section 4).
        foreground: (h, w, 3) uint8 sRGB, the tree's own colour in every pixel, free of background.
        method: how it came about: "alpha channel", "trimap", "scribbles" or "automatic".
        unknown: (h, w) bool, pixels about which the matte says nothing because something stands before the
            tree there (a lamp post, a car); alpha is a guess from around. None where every pixel is known.
    """

    alpha: NDArray[np.float32]
    foreground: NDArray[np.uint8]
    method: str
    unknown: NDArray[np.bool_] | None = None
