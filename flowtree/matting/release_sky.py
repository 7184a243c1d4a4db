"""Takes back from the sky what a scribble says is the tree: snow, blossom, a pale stem."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
from numpy.typing import NDArray

from flowtree.matting.find_sky import FAR, Sky
from flowtree.matting.rate_likeness import Window, rate_likeness

_ALIKE = (
    3.0 * FAR
)  # a scribble whose pixels are mostly nearer to the sky than this speaks of the sky's colours
_SKY_NOISE, _TREE_NOISE = 1.5, 3.0  # of their colours beyond what their moments tell [CIELAB]
_REACHES = (0.08, 0.4)  # of the scribble's word [larger side]
_MIXED = 0.1  # share of mixtures among the pixels in question
_OFF = 99.0  # distance from the sky of what certainly is none


def release_sky(
    lab: NDArray[np.float32], sky: Sky, tree: NDArray[np.bool_]
) -> tuple[Sky, NDArray[np.float32]]:
    """Releases pixels that look more like the scribbled tree than like the sky near them.

    Only a stroke most of which looks like the sky teaches anything: one across a crown with gaps covers some
    sky, too, and must not fill all gaps. Three things may explain a pixel: the sky near it, the scribbled
    colours (a Gaussian near the stroke and a wider one), or a mixture of leaf and sky, whose colours lie
    evenly on the line between the two.

    Args:
        lab: (h, w, 3) CIELAB.
        sky: as it was found.
        tree: (h, w), scribbled as tree.

    Returns: the sky without them, and the probability (h, w) that a pixel is such tree.
    """
    nothing = np.zeros(tree.shape, np.float32)
    taught = _strokes_like_sky(tree, sky.distance)
    if sky.colors is None or not taught.any():
        return sky, nothing
    size = max(tree.shape)
    windows = [
        Window(reach * size, reach * size, trust) for reach, trust in zip(_REACHES, (1.0, 0.3), strict=True)
    ]
    like_tree = rate_likeness(lab, taught.astype(np.float32), windows, noise=_TREE_NOISE)
    like_sky = -0.5 * sky.colors.distance(lab, _SKY_NOISE) ** 2 - 0.5 * sky.colors.log_determinant(_SKY_NOISE)
    like_mixture = _like_mixture(lab, sky)
    other = np.logaddexp(like_sky, like_mixture)
    odds = cv2.GaussianBlur(np.clip(like_tree - other, -8.0, 8.0), (0, 0), 0.8)
    chance = (1.0 / (1.0 + np.exp(-odds))).astype(np.float32)
    free = chance > 0.5
    distance = np.where(free, np.maximum(sky.distance, np.float32(_OFF)), sky.distance)
    return replace(sky, mask=sky.mask & ~free, distance=distance.astype(np.float32)), chance


def _like_mixture(lab: NDArray[np.float32], sky: Sky) -> NDArray[np.float32]:
    """Log-likelihood (h, w) of a mixture: even along the line from the sky to the solid, noisy across it."""
    assert sky.colors is not None
    solid = (sky.distance > FAR) & ~sky.mask
    end = lab[solid].mean(axis=0) if solid.any() else np.zeros(3, np.float32)
    line = end - sky.colors.mean
    length = np.maximum(np.sqrt((line**2).sum(axis=2)), 1.0)
    away = lab - sky.colors.mean
    along = np.clip((away * line).sum(axis=2) / length**2, 0.0, 1.0)
    across = ((away - along[..., None] * line) ** 2).sum(axis=2) / _TREE_NOISE**2
    rated = np.log(_MIXED) - np.log(length) - 2.0 * np.log(_TREE_NOISE) + 0.5 * np.log(2.0 * np.pi)
    likelihood: NDArray[np.float32] = (rated - 0.5 * across).astype(np.float32)
    return likelihood


def _strokes_like_sky(tree: NDArray[np.bool_], distance: NDArray[np.float32]) -> NDArray[np.bool_]:
    """The pixels with the sky's colours of those strokes that have them for the most part."""
    count, parts = cv2.connectedComponents(tree.astype(np.uint8), connectivity=8)
    alike = tree & (distance < _ALIKE)
    share = np.bincount(parts.ravel(), alike.ravel(), count) / np.bincount(parts.ravel(), minlength=count)
    share[0] = 0.0
    found: NDArray[np.bool_] = (share > 0.5)[parts] & alike
    return found
