"""Which pixels are sky, and what the sky behind the tree looks like."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from flowtree.matting.fit_local_gaussian import LocalGaussian, fit_local_gaussian

NEAR = 2.5  # Mahalanobis distance below which a colour is the sky's
FAR = 5.0  # and above which it is not
_NOISE = 1.5  # of the sky's colours beyond what its moments tell [CIELAB]
_SMOOTH, _ROUGH = (
    3.0,
    8.0,
)  # deviation of CIELAB in a small window: sky and cloud below, leaves and twigs above
_BLUE = -12.0  # b* of a sky that needs no brightness to be one


@dataclass(frozen=True)
class Sky:
    """The sky of a picture.

    Attributes:
        mask: (h, w) bool, what certainly is sky; empty where none was found.
        distance: (h, w) float32, how many standard deviations a pixel is from the sky near it.
        colors: the sky's colours near every pixel; None where none was found.
    """

    mask: NDArray[np.bool_]
    distance: NDArray[np.float32]
    colors: LocalGaussian | None


def find_sky(
    lab: NDArray[np.float32], texture: NDArray[np.float32], backdrop: NDArray[np.bool_] | None = None
) -> Sky:
    """Finds the sky by smoothness first, then by its colours near every pixel.

    Smooth patches of the upper half that are blue, or brighter than what is rough, are seeds. A Gaussian of
    their colours around every pixel then claims the clouds, the gradients and the gaps between twigs: a
    patch of matching colour is accepted where it lies near accepted sky, so that the sky creeps through a
    crown but does not jump over a hedge to a pale road.

    Args:
        lab: (h, w, 3) float32 CIELAB.
        texture: (h, w) local deviation of the colours.
        backdrop: (h, w) bool, pixels known to lie behind the tree (picked colours); they are seeds too.
    """
    height, width = texture.shape
    seeds = _find_seeds(lab, texture)
    if backdrop is not None:
        seeds |= backdrop
    none = Sky(np.zeros_like(seeds), np.full((height, width), 99.0, np.float32), None)
    if seeds.mean() < 0.002:
        return none
    radius = max(2, round(0.035 * height))
    window = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * radius + 1, 2 * radius + 1))
    mask = seeds
    for last in (False, True):
        colors = fit_local_gaussian(lab, mask.astype(np.float32))
        distance = colors.distance(lab, _NOISE)
        whole = _global_distance(lab, mask)
        distance = np.minimum(distance, 1.25 * whole)
        mask = _spread(mask, (distance < NEAR) | mask, window)
        if not last and (mask & (texture < _ROUGH)).any():
            mask &= texture < _ROUGH
            if not mask.any():  # a picture of leaves or noise from edge to edge
                return none
    return Sky(mask, distance.astype(np.float32), colors)


def _find_seeds(lab: NDArray[np.float32], texture: NDArray[np.float32]) -> NDArray[np.bool_]:
    height = texture.shape[0]
    calm = float((texture < _SMOOTH).mean()) > 0.02
    # A bare tree that fills the picture leaves only gaps: there the smoothest tenth must do.
    limit = _SMOOTH if calm else max(_SMOOTH, float(np.quantile(texture[: height // 2], 0.1)))
    light, green_red, blue_yellow = lab[..., 0], lab[..., 1], lab[..., 2]
    rough = texture > _ROUGH
    ground = float(np.median(light[rough])) if rough.sum() > 50 else 40.0
    plant = (blue_yellow > 8.0) & (green_red < -4.0)
    blue = (texture < limit) & ~plant & (blue_yellow < _BLUE)
    seeds = (texture < limit) & ~plant & ((blue_yellow < _BLUE) | (light > ground + 8.0))
    if not calm and blue.sum() > 0.3 * seeds.sum():
        seeds = blue  # under a blue sky a smooth bright patch is bark
    count, parts, boxes, centres = cv2.connectedComponentsWithStats(seeds.astype(np.uint8), connectivity=4)
    # Where open sky shows, small patches may be snow or a lit leaf; gaps are claimed by their colour later.
    keep = boxes[:, cv2.CC_STAT_AREA] >= (max(6.0, 5e-4 * seeds.size) if calm else 2)
    keep &= (boxes[:, cv2.CC_STAT_TOP] < 0.55 * height) & (centres[:, 1] < 0.7 * height)
    keep[0] = False
    kept: NDArray[np.bool_] = keep[parts] if count > 1 else np.zeros_like(seeds)
    # At dusk the sky is neither blue nor brighter than the leaves, but still smooth, wide and on top.
    _, parts, boxes, _ = cv2.connectedComponentsWithStats(
        ((texture < _SMOOTH) & ~plant).astype(np.uint8), connectivity=4
    )
    wide = (boxes[:, cv2.CC_STAT_AREA] >= 0.02 * seeds.size) & (boxes[:, cv2.CC_STAT_TOP] < 0.03 * height)
    wide[0] = False
    kept |= wide[parts]
    return kept


def _global_distance(lab: NDArray[np.float32], mask: NDArray[np.bool_]) -> NDArray[np.float32]:
    """Distance from the colours of the whole sky: a cloud between twigs looks like a cloud elsewhere."""
    pixels = lab[mask].astype(np.float64)
    mean = pixels.mean(axis=0)
    covariance = (pixels - mean).T @ (pixels - mean) / len(pixels) + _NOISE**2 * np.eye(3)
    whiten = np.linalg.cholesky(np.linalg.inv(covariance)).astype(np.float32)
    distance: NDArray[np.float32] = np.linalg.norm((lab - mean.astype(np.float32)) @ whiten, axis=2)
    return distance


def _spread(known: NDArray[np.bool_], like: NDArray[np.bool_], window: NDArray[Any]) -> NDArray[np.bool_]:
    """Accepts the connected patches of ``like`` that come near what is known, until none is left."""
    count, parts = cv2.connectedComponents(like.astype(np.uint8), connectivity=8)
    accepted = np.zeros(count, bool)
    while True:
        near = (cv2.dilate(known.astype(np.uint8), window) > 0) & like
        touched = np.zeros(count, bool)
        touched[np.unique(parts[near])] = True
        touched[0] = False
        if not (touched & ~accepted).any():
            spread: NDArray[np.bool_] = accepted[parts]
            return spread
        accepted |= touched
        known = accepted[parts]
