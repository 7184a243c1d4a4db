"""The colour of bark in the light."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flowtree.geometry.srgb import decode_srgb, encode_srgb

_DARK = 0.09  # linear brightness below which bark is in the shade: hardly any is darker
_LIFT = 0.5  # of the way there, as logarithms
_PLAIN = np.array([1.22, 0.97, 0.74])  # grey brown, relative to its brightness


def light_bark(color: NDArray[np.float64]) -> NDArray[np.float64]:
    """The colour that dark bark would have without the shadow in which it was photographed.

    Most trunks stand in the shadow of their crowns, which every renderer casts once more. Deep shadow also
    takes the colour of the sky or of the leaves around: the darker it is, the nearer it is taken to a grey
    brown.

    Args:
        color: (3,) sRGB, 0..255.

    Returns: the same where it is not dark.
    """
    linear = decode_srgb(color / 255.0)
    bright = max(float(linear.mean()), 1e-3)
    if bright >= _DARK:
        return np.asarray(color, np.float64)
    shade = (bright / _DARK) ** _LIFT
    hue = linear / max(float(linear.mean()), 1e-6) if linear.any() else _PLAIN
    return np.asarray(255.0 * encode_srgb(_DARK * shade * (shade * hue + (1.0 - shade) * _PLAIN)))
