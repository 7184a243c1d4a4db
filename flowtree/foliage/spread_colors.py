"""The leaves' colours around every pixel of a photo."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
from numpy.typing import NDArray

from flowtree.foliage.bark_likeness import bark_likeness
from flowtree.geometry.srgb import LIGHT_OF_BYTE
from flowtree.model.camera import Camera
from flowtree.model.matte import Matte

_BLUR = 0.004  # of the picture's height: about a leaf, so that one dark pixel between leaves does not count
_SOLID = 4  # power of alpha that weighs a pixel: half-covered ones still hold some of the sky
_WIDE, _FAR = 6.0, 0.02  # a neighbourhood so many times wider counts so much, where the near one has no leaf
_UNUSUAL = 3.0  # robust standard deviations at which a colour is no longer the crown's


def spread_colors(matte: Matte, camera: Camera) -> NDArray[np.float32]:
    """Weighted means of the tree's colours, from farther away where all near weights are small.

    Pixels in the colour of the trunk count little, and so do those of a hue or a brightness that the crown
    hardly has: a twig's white bark, or sky that shone through where the matte closed a gap, is no leaf's
    colour, and the sky's light is so strong that a little of it bleaches all leaves around.

    Args:
        matte: with the foreground's colours.
        camera: of the view; only its foot counts.

    Returns: (h, w, 3) float32 in 0..1, linear; beside the tree's box what is at its edge.
    """
    rows, columns = (np.flatnonzero((matte.alpha > 0).any(axis=axis)) for axis in (1, 0))
    if not len(rows):
        return np.zeros((*matte.alpha.shape, 3), np.float32)
    top, left, bottom, right = int(rows[0]), int(columns[0]), int(rows[-1]) + 1, int(columns[-1]) + 1
    box = (slice(top, bottom), slice(left, right))
    part = replace(matte, alpha=matte.alpha[box], foreground=np.ascontiguousarray(matte.foreground[box]))
    view = replace(camera, foot=(camera.foot[0] - left, camera.foot[1] - top))
    made = _spread(part, view, max(_BLUR * len(matte.alpha), 0.5))
    around = (top, len(matte.alpha) - bottom, left, matte.alpha.shape[1] - right)
    return np.asarray(cv2.copyMakeBorder(made, *around, cv2.BORDER_REPLICATE), np.float32)


def _spread(matte: Matte, camera: Camera, sigma: float) -> NDArray[np.float32]:
    """The same for the tree's box alone."""
    weight = matte.alpha**_SOLID * (1.02 - bark_likeness(matte, camera)) * _usual_color(matte) + 1e-5
    light = np.asarray(cv2.LUT(matte.foreground, LIGHT_OF_BYTE.astype(np.float32)), np.float32)
    height, width = weight.shape
    weights = np.asarray(weight, np.float32)
    sums = cv2.merge([*cv2.split(light * cv2.merge([weights] * 3)), weights])
    # The wide mean is smooth: a picture a quarter as large holds all of it.
    small = cv2.resize(sums, (max(1, width // 4), max(1, height // 4)), interpolation=cv2.INTER_AREA)
    wide = cv2.resize(cv2.GaussianBlur(small, (0, 0), _WIDE * sigma / 4), (width, height))
    both = cv2.scaleAdd(wide, _FAR, cv2.GaussianBlur(sums, (0, 0), sigma))
    return np.asarray(both[..., :3] / both[..., 3:], np.float32)


def _usual_color(matte: Matte) -> NDArray[np.float32]:
    """How usual each pixel's colour is in the crown: 1 near the median of CIELAB, less far from it.

    A pixel may be darker than the crown as it likes, which is shadow.
    """
    lab = cv2.cvtColor(matte.foreground.astype(np.float32) / 255, cv2.COLOR_RGB2LAB)
    solid = matte.alpha > 0.8
    if not solid.any():
        return np.ones(matte.alpha.shape, np.float32)
    gaps = [np.ascontiguousarray(lab[..., k]) for k in range(3)]
    gaps = [part - np.median(part[solid]) for part in gaps]
    # Even a crown of one colour has a few units.
    light, red, yellow = (gap / (1.4826 * np.median(np.abs(gap[solid])) + 3.0) for gap in gaps)
    light = np.maximum(light, 0.0)
    far = np.sqrt(light * light + red * red + yellow * yellow) / _UNUSUAL
    return np.asarray(1.0 / (1.0 + far**4), np.float32)
