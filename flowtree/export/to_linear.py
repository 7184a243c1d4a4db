"""From the numbers of a picture to the light they stand for."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def to_linear(srgb: NDArray[np.float64]) -> NDArray[np.float64]:
    """The linear light of sRGB values, both in 0..1 (IEC 61966-2-1)."""
    return np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)
