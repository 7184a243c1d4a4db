"""The colours of leaves in the light."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

_LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
_DARK = 0.08  # linear brightness below which a crown is in the shade: hardly any leaf is darker
_LIFT = 0.5  # of the way there, as logarithms
_RARE = 0.3  # of the leaves, whose blue may not be their own
_VARIES, _RESTS = 0.1, 0.3  # logarithm of the share of blue that any crown varies by; what stays of more
_SHADOW = 0.5  # of a leaf's shadow, as logarithms, that its colour keeps


def light_leaves(color: NDArray[np.float64]) -> NDArray[np.float64]:
    """The colours without much of the shadow in which they were photographed.

    A photograph holds the light of its hour, and shadows that the crown casts on itself; every renderer casts
    them once more. So what is darker than the crown's median comes nearer to it, and a crown photographed at
    dusk or against the light becomes brighter as a whole.

    Leaves bluer than most of a crown are mixed with sky or cloud, which shone through or was mirrored: they
    come nearer to the others.

    Args:
        color: (n, 3) linear.

    Returns: (n, 3); the same where all leaves are equally bright and not dark.
    """
    if not len(color):
        return color
    bright = np.maximum(color @ _LUMINANCE, 1e-4)
    blue = np.log(np.maximum(color[:, 2] / bright, 1e-3))
    most = float(np.quantile(blue, 1.0 - _RARE)) + _VARIES
    blue = np.where(blue > most, most + _RESTS * (blue - most), blue)
    color = np.stack([color[:, 0], color[:, 1], bright * np.exp(blue)], axis=1)
    color *= (bright / np.maximum(color @ _LUMINANCE, 1e-4))[:, None]
    usual = float(np.median(bright))
    factor = np.maximum(usual / bright, 1.0) ** (1.0 - _SHADOW)
    if usual < _DARK:  # but what is in the light already stays as it is
        factor *= np.maximum((_DARK / np.maximum(bright, usual)) ** _LIFT, 1.0)
    return np.asarray(color * factor[:, None])
