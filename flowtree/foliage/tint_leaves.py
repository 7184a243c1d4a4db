"""The leaves' colours where no photo shows them."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri

from flowtree.geometry.place_chance import place_chance
from flowtree.geometry.read_color import read_color
from flowtree.geometry.srgb import decode_srgb

_GREEN = "#5f7f38"
_USUAL = {  # of each shape's leaves in summer
    "lanceolate": "#6f8a48",
    "needle": "#486138",
    "frond": "#5c7d33",
    "compound": "#587a36",
    "blossom": "#f0cfd8",
}
_TEXTURE = 0.8  # brightness of a leaf texture's mean, which is multiplied with the colour
_WARM = np.array([1.0, 0.15, -0.8])  # what red, green and blue gain where a leaf is yellower


def tint_leaves(
    code: NDArray[np.integer[Any]],
    number: NDArray[np.integer[Any]],
    *,
    shape: str,
    color: str = "auto",
    variation: float,
    seed: int = 0,
) -> NDArray[np.float32]:
    """Each leaf's colour varies around one, in brightness and, half as much, from green to yellow.

    Args:
        code: (n,) of the leaves' places.
        number: (n,) of two random numbers of each place that nothing else takes, the first one's.
        shape: of the leaf, for its usual colour.
        color: #rrggbb, or auto.
        variation: standard deviation of the brightness from leaf to leaf, relative.
        seed: of the variation.

    Returns: (n, 3) float32 in 0..1, linear, to be multiplied with a texture of mean brightness 0.8.

    Raises:
        InputError: no such colour.
    """
    text = _USUAL.get(shape, _GREEN) if color == "auto" else color
    mean = decode_srgb(read_color(text, "leaf color") / 255.0) / _TEXTURE

    def normal(stream: int) -> NDArray[np.float64]:
        return np.asarray(ndtri(1e-9 + (1.0 - 2e-9) * place_chance(code, seed, number + stream)))

    bright = np.clip(1.0 + variation * normal(0), 0.4, 1.8)[:, None]
    warm = np.clip(1.0 + 0.5 * variation * normal(1)[:, None] * _WARM, 0.4, 1.8)
    return np.asarray(np.clip(mean * bright * warm, 0.0, 1.0), np.float32)
