"""The leaves' colours, from the photos (Particle Flows, section 8)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from flowtree.foliage.light_leaves import light_leaves
from flowtree.geometry.projection import project, view_axes
from flowtree.model.camera import Camera
from flowtree.model.matte import Matte

_TEXTURE = 0.8  # brightness of a leaf texture's mean, which is multiplied with the colour


def color_leaves(
    points: NDArray[np.float64],
    mattes: Sequence[Matte],
    colors: Sequence[NDArray[np.float32]],
    cameras: Sequence[Camera],
    *,
    variation: float,
    seed: int = 0,
) -> NDArray[np.float32]:
    """Each leaf's colour is the tree's own where the leaf projects, in the view in whose foreground it is.

    Much of the shadow in it is taken out (`light_leaves`).

    Args:
        points: (n, 3) [m].
        mattes: one a view.
        colors: what `spread_colors` gives for each.
        cameras: one a matte.
        variation: standard deviation of the brightness from leaf to leaf, relative.
        seed: of the variation.

    Returns: (n, 3) float32 in 0..1, linear, to be multiplied with a texture of mean brightness 0.8.
    """
    seen = [_look_up(points, *view) for view in zip(mattes, colors, cameras, strict=True)]
    found, nearness = zip(*seen, strict=True)
    color = np.stack(found)[np.argmax(nearness, axis=0), np.arange(len(points))].astype(np.float64)
    color = light_leaves(color)
    bright = np.random.default_rng(seed).normal(1.0, variation, (len(points), 1))
    return np.asarray(np.clip(color / _TEXTURE * np.clip(bright, 0.4, 1.8), 0.0, 1.0), np.float32)


def _look_up(
    points: NDArray[np.float64], matte: Matte, colors: NDArray[np.float32], camera: Camera
) -> tuple[NDArray[np.float32], NDArray[np.float64]]:
    """The tree's colours (n, 3), linear, where points project in a view, and how near it they are (n,)."""
    pixel = np.floor(project(points, camera)).astype(int)
    column = np.clip(pixel[:, 0], 0, matte.alpha.shape[1] - 1)
    row = np.clip(pixel[:, 1], 0, matte.alpha.shape[0] - 1)
    # A pixel that hardly holds tree has no colour to give, however near the leaf is to the camera.
    hidden = matte.alpha[row, column] < 0.1
    return colors[row, column], np.asarray(points @ view_axes(camera.yaw)[2] - 1e3 * hidden, np.float64)
