"""A texture in another colour, for formats that cannot multiply it themselves."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flowtree.geometry.srgb import LIGHT_OF_BYTE, encode_srgb_bytes


def tint_texture(pixels: NDArray[np.uint8], color: NDArray[np.float64]) -> NDArray[np.uint8]:
    """Multiplies a picture (h, w, 3 or 4) with a colour (3,), 0..1, in linear light; alpha stays."""
    tinted = pixels.copy()
    for channel in range(3):
        tinted[:, :, channel] = encode_srgb_bytes(LIGHT_OF_BYTE * color[channel])[pixels[:, :, channel]]
    return tinted
