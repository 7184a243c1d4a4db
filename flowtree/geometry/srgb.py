"""Between the numbers of a picture and the light they stand for (sRGB, IEC 61966-2-1)."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray


def decode_srgb(coded: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
    """The linear light of sRGB values, both in 0..1, of any shape."""
    value = coded.astype(np.float64)
    return np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)


def encode_srgb(linear: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
    """Linear light as sRGB values, both in 0..1, of any shape; what is darker or brighter is clipped."""
    light = np.clip(linear.astype(np.float64), 0.0, 1.0)
    return np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)


def encode_srgb_bytes(linear: NDArray[np.floating[Any]]) -> NDArray[np.uint8]:
    """Linear light in 0..1 as the bytes of a picture, of any shape."""
    return np.rint(255.0 * encode_srgb(linear)).astype(np.uint8)


#: (256,) float64, the linear light of every byte: ``LIGHT_OF_BYTE[picture]`` decodes a uint8 picture.
LIGHT_OF_BYTE: NDArray[np.float64] = decode_srgb(np.arange(256) / 255.0)
LIGHT_OF_BYTE.flags.writeable = False
