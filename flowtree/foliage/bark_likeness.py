"""Which pixels of a matte show bark, not leaves."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from flowtree.model.camera import Camera
from flowtree.model.matte import Matte

_STEM = 0.1  # of the height: the lowest part, where a tree shows its bark
_LIMB = 0.004  # of the height: half the width of a limb that leaves do not cover
_ALIKE, _OTHER = 8.0, 22.0  # distances in CIELAB at which a colour is the bark's, and is clearly another one


def bark_likeness(matte: Matte, camera: Camera) -> NDArray[np.float32]:
    """How surely each pixel shows bark: 1 in the colour of the trunk's foot, 0 in clearly another one.

    Where most of the crown has the colour of the trunk (at dusk, in autumn, of a bare tree) colour tells
    nothing and the answer is 0 throughout.

    Returns: (h, w) float32 in 0..1.
    """
    foot = int(np.clip(camera.foot[1], 1, matte.alpha.shape[0]))
    rows = np.flatnonzero((matte.alpha[:foot] > 0.3).any(axis=1))
    nothing = np.zeros(matte.alpha.shape, np.float32)
    if not len(rows):
        return nothing
    lab = cv2.cvtColor(matte.foreground.astype(np.float32) / 255, cv2.COLOR_RGB2LAB)
    stem = int(foot - _STEM * (foot - rows[0]))
    solid = matte.alpha > 0.8
    if not solid[stem:foot].any() or not solid[:stem].any():
        return nothing
    bark = np.median(lab[stem:foot][solid[stem:foot]], axis=0)
    light, red, yellow = (part - middle for part, middle in zip(cv2.split(lab), bark, strict=True))
    gap = np.sqrt(light * light + red * red + yellow * yellow)
    if np.median(gap[:stem][solid[:stem]]) < _OTHER:
        return nothing
    return np.asarray(np.clip((_OTHER - gap) / (_OTHER - _ALIKE), 0.0, 1.0), np.float32)


def visible_limbs(matte: Matte, camera: Camera) -> NDArray[np.float32]:
    """Bark as wide as a limb, where no leaf hangs; between thin branches leaves may: (h, w) in 0..1."""
    radius = max(1, round(_LIMB * camera.foot[1]))
    disc = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * radius + 1, 2 * radius + 1))
    return np.asarray(cv2.morphologyEx(bark_likeness(matte, camera), cv2.MORPH_OPEN, disc), np.float32)
