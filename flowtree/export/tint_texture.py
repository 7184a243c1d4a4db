"""A texture in another colour, for formats that cannot multiply it themselves."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flowtree.export.to_linear import to_linear
from flowtree.export.to_srgb import to_srgb


def tint_texture(pixels: NDArray[np.uint8], color: NDArray[np.float64]) -> NDArray[np.uint8]:
    """Multiplies a picture (h, w, 3 or 4) with a colour (3,), 0..1, in linear light; alpha stays."""
    light = to_linear(np.arange(256) / 255.0)
    tinted = pixels.copy()
    for channel in range(3):
        tinted[:, :, channel] = to_srgb(light * color[channel])[pixels[:, :, channel]]
    return tinted
