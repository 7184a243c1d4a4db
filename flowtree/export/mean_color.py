"""The one colour a texture has from afar."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flowtree.geometry.srgb import LIGHT_OF_BYTE
from flowtree.model.mesh import Material


def mean_color(material: Material) -> NDArray[np.float64]:
    """The mean of the texture in linear light, weighted with its alpha: (3,) in 0..1."""
    pixels = material.base_color.reshape(-1, material.base_color.shape[2])
    alpha = pixels[:, 3].astype(np.float64) if pixels.shape[1] == 4 else np.ones(len(pixels))
    weight = alpha if alpha.any() else np.ones(len(pixels))
    mean: NDArray[np.float64] = weight @ LIGHT_OF_BYTE[pixels[:, :3]] / weight.sum()
    return mean
