"""The leaves' colours, from the photos (Particle Flows, section 8)."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from flowtree.device import side_by_side
from flowtree.foliage.bark_likeness import bark_likeness
from flowtree.geometry.projection import project, view_axes
from flowtree.geometry.srgb import LIGHT_OF_BYTE
from flowtree.model.camera import Camera
from flowtree.model.matte import Matte

_BLUR = 0.004  # of the picture's height: about a leaf, so that one dark pixel between leaves does not count
_SOLID = 4  # power of alpha that weighs a pixel: half-covered ones still hold some of the sky
_WIDE, _FAR = 6.0, 0.02  # a neighbourhood so many times wider counts so much, where the near one has no leaf
_HUE = 3.0  # robust standard deviations at which a hue is no longer the crown's
_TEXTURE = 0.8  # brightness of a leaf texture's mean, which is multiplied with the colour


def color_leaves(
    points: NDArray[np.float64],
    mattes: Sequence[Matte],
    cameras: Sequence[Camera],
    *,
    variation: float,
    seed: int = 0,
) -> NDArray[np.float32]:
    """Each leaf's colour is the tree's own where the leaf projects, in the view in whose foreground it is.

    Pixels in the colour of the trunk count little, and so do those of a hue that the crown hardly has: a
    twig's white bark, or sky that shone through where the matte closed a gap, is no leaf's colour.

    Args:
        points: (n, 3) [m].
        mattes: with the foreground's colours.
        cameras: one a matte.
        variation: standard deviation of the brightness from leaf to leaf, relative.
        seed: of the variation.

    Returns: (n, 3) float32 in 0..1, linear, to be multiplied with a texture of mean brightness 0.8.
    """

    def of_view(matte: Matte, camera: Camera) -> tuple[NDArray[np.float32], NDArray[np.float64]]:
        return _seen_colors(points, matte, camera)

    colors, nearness = zip(*side_by_side(of_view, mattes, cameras), strict=True)
    color = np.stack(colors)[np.argmax(nearness, axis=0), np.arange(len(points))].astype(np.float64)
    bright = np.random.default_rng(seed).normal(1.0, variation, (len(points), 1))
    return np.asarray(np.clip(color / _TEXTURE * np.clip(bright, 0.4, 1.8), 0.0, 1.0), np.float32)


def _seen_colors(
    points: NDArray[np.float64], matte: Matte, camera: Camera
) -> tuple[NDArray[np.float32], NDArray[np.float64]]:
    """The tree's colours (n, 3), linear, where points project in a view, and how near it they are (n,)."""
    weight = matte.alpha**_SOLID * (1.02 - bark_likeness(matte, camera)) * _usual_hue(matte) + 1e-5
    pixel = np.floor(project(points, camera)).astype(int)
    column = np.clip(pixel[:, 0], 0, matte.alpha.shape[1] - 1)
    row = np.clip(pixel[:, 1], 0, matte.alpha.shape[0] - 1)
    light = np.asarray(cv2.LUT(matte.foreground, LIGHT_OF_BYTE.astype(np.float32)), np.float32)
    color = _local_mean(light, np.asarray(weight, np.float32), row, column)
    # A pixel that hardly holds tree has no colour to give, however near the leaf is to the camera.
    hidden = matte.alpha[row, column] < 0.1
    return color, np.asarray(points @ view_axes(camera.yaw)[2] - 1e3 * hidden, np.float64)


def _usual_hue(matte: Matte) -> NDArray[np.float32]:
    """How usual each pixel's hue is in the crown: 1 near the median of CIELAB's a and b, less far from it."""
    lab = cv2.cvtColor(matte.foreground.astype(np.float32) / 255, cv2.COLOR_RGB2LAB)
    solid = matte.alpha > 0.8
    if not solid.any():
        return np.ones(matte.alpha.shape, np.float32)
    hue = [np.ascontiguousarray(lab[..., 1]), np.ascontiguousarray(lab[..., 2])]
    gaps = [part - np.median(part[solid]) for part in hue]
    # Even a crown of one hue has a few units.
    red, yellow = (gap / (1.4826 * np.median(np.abs(gap[solid])) + 3.0) for gap in gaps)
    far = np.sqrt(red * red + yellow * yellow) / _HUE
    return np.asarray(1.0 / (1.0 + far**4), np.float32)


def _local_mean(
    light: NDArray[np.float32],
    weight: NDArray[np.float32],
    row: NDArray[np.intp],
    column: NDArray[np.intp],
) -> NDArray[np.float32]:
    """Weighted mean (n, 3) of the light around pixels, from farther away where all near weights are small."""
    height, width = weight.shape
    sigma = max(_BLUR * height, 0.5)
    sums = cv2.merge([*cv2.split(light * cv2.merge([weight] * 3)), weight])
    near = cv2.GaussianBlur(sums, (0, 0), sigma)
    # The wide mean is smooth: a picture a quarter as large holds all of it.
    small = cv2.resize(sums, (max(1, width // 4), max(1, height // 4)), interpolation=cv2.INTER_AREA)
    wide = cv2.resize(cv2.GaussianBlur(small, (0, 0), _WIDE * sigma / 4), (width, height))
    both = near[row, column] + np.float32(_FAR) * wide[row, column]
    return np.asarray(both[:, :3] / both[:, 3:], np.float32)
