"""From the light of the colours in the model to the bytes of a picture."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray


def to_srgb(linear: NDArray[np.floating[Any]]) -> NDArray[np.uint8]:
    """Linear light in 0..1 as sRGB bytes (IEC 61966-2-1)."""
    light = np.clip(linear.astype(np.float64), 0.0, 1.0)
    coded = np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)
    return np.rint(255.0 * coded).astype(np.uint8)
