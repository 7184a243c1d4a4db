"""Tells the tree from hedges, lawns and other trees where no sky lies behind it."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from flowtree.matting.find_crown import Crown
from flowtree.matting.fit_local_gaussian import fit_local_gaussian

_BINS = (20, 30, 30, 8)  # L*, a*, b*, texture
_LOW, _HIGH = np.array([0.0, -60.0, -60.0, 0.0]), np.array([100.0, 60.0, 60.0, 4.2])
_NOISE = 4.0  # of local colours [CIELAB]: leaves differ by that much among themselves


def label_tree(
    rgb: NDArray[np.uint8],
    lab: NDArray[np.float32],
    texture: NDArray[np.float32],
    sky: NDArray[np.bool_],
    crown: Crown,
    evidence: NDArray[np.float32],
    *,
    rounds: int,
) -> NDArray[np.float32]:
    """Probability (h, w) that a pixel that is no sky belongs to the tree.

    The crown before the sky teaches what the tree looks like, the ground beside and below it what the rest
    looks like: histograms of colour and texture for the whole picture and a Gaussian of the colours near
    every pixel. The log-likelihood ratio is smoothed along edges (guided filter), joined with where a tree
    can be (the outline of the crown continued downwards), and both models are learned again from the result.

    Args:
        rgb: (h, w, 3).
        lab: (h, w, 3) CIELAB.
        texture: (h, w) local deviation of the colours.
        sky: (h, w).
        crown: what shows before the sky.
        evidence: (h, w) log-odds known beforehand: scribbles, picked colours, rows beside a visible trunk.
        rounds: how often the models are learned.
    """
    height = sky.shape[0]
    solid = ~sky
    hidden = np.arange(height)[:, None] > crown.horizon[None, :]
    prior, outside = _place_prior(sky, crown)
    prior += evidence
    features = np.dstack([lab, np.log1p(cv2.blur(texture, (5, 5)))])
    cell = ((features - _LOW) / (_HIGH - _LOW) * _BINS).astype(np.int64)
    cells = np.ravel_multi_index(tuple(np.clip(cell, 0, np.array(_BINS) - 1).transpose(2, 0, 1)), _BINS)
    tree = np.where(prior > 1.0, 1.0, 0.0) * solid
    rest = np.where((outside & ~crown.core & (evidence < 1.0)) | (evidence < -1.0), 1.0, 0.0) * solid
    probability = tree.astype(np.float32)
    for _ in range(rounds):
        ratio: NDArray[Any] = 1.5 * _colour_ratio(lab, cells, tree, rest)
        ratio = np.where(solid, ratio, 0.0).astype(np.float32)
        ratio = cv2.ximgproc.guidedFilter(rgb, ratio, max(2, round(0.012 * height)), 50.0)
        ratio = cv2.GaussianBlur(ratio, (0, 0), 0.008 * height)
        probability = (1.0 / (1.0 + np.exp(-np.clip(ratio + prior, -20.0, 20.0)))).astype(np.float32)
        probability[sky] = 0.0
        probability = _close_holes(_keep_connected(probability, crown.core), solid & hidden)
        tree = np.where(probability > 0.6, probability, 0.0) * solid
        rest = np.where(probability < 0.1, 1.0 - probability, 0.0) * solid
    return probability


def _place_prior(sky: NDArray[np.bool_], crown: Crown) -> tuple[NDArray[np.float32], NDArray[np.bool_]]:
    """Log-odds from the place alone, and the ground that no crown reaches."""
    height, width = sky.shape
    rows, columns = np.mgrid[:height, :width].astype(np.float32)
    inside = np.minimum(columns - crown.left[:, None], crown.right[:, None] - columns)
    depth = (rows - crown.horizon[None, :]) / height
    prior = np.clip(inside / (0.1 * crown.width), -3.0, 0.8)
    prior = prior - np.clip(depth / 0.3 - 0.1, 0.0, 3.0)
    prior -= 3.0 * (rows > 0.93 * height)
    # What stands before the sky far from the middle may be a neighbour that touches the crown.
    central = np.exp(-(((columns - crown.centre) / (0.6 * crown.width)) ** 2))
    prior[crown.core] = (0.8 + 2.2 * central)[crown.core]
    other = ~sky & (depth < -0.03) & ~crown.core
    prior[other] = np.minimum(prior[other], -1.0)
    place: NDArray[np.float32] = prior.astype(np.float32)
    outside = (depth > 0.0) & ((inside < -0.25 * crown.width) | (rows > 0.9 * height))
    return place, outside


def _colour_ratio(
    lab: NDArray[np.float32], cells: NDArray[np.int64], tree: NDArray[np.float64], rest: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Log-likelihood ratio of the colours: histograms of the whole picture and Gaussians near the pixel."""
    least = 1e-5
    share = [_histogram(cells, weight)[cells] + least for weight in (tree, rest)]
    ratio = np.clip(np.log(share[0] / share[1]), -3.0, 3.0)
    likelihood = []
    for weight in (tree, rest):
        near = fit_local_gaussian(lab, weight.astype(np.float32))
        spread = near.log_determinant(_NOISE)
        likelihood.append(-0.5 * (near.distance(lab, _NOISE) ** 2 + spread))
    total: NDArray[np.float64] = ratio + 0.5 * np.clip(likelihood[0] - likelihood[1], -4.0, 4.0)
    return total


def _histogram(cells: NDArray[np.int64], weight: NDArray[np.float64]) -> NDArray[np.float64]:
    counts = np.bincount(cells.ravel(), weight.ravel(), int(np.prod(_BINS))).reshape(_BINS)
    smooth = ndimage.gaussian_filter(counts, (1.0, 1.2, 1.2, 0.7), mode="nearest")
    flat: NDArray[np.float64] = smooth.ravel() / max(float(smooth.sum()), 1e-9)
    return flat


def _keep_connected(probability: NDArray[np.float32], core: NDArray[np.bool_]) -> NDArray[np.float32]:
    """Doubts every patch that does not hang together with the crown."""
    likely = probability > 0.5
    count, parts = cv2.connectedComponents(likely.astype(np.uint8), connectivity=8)
    shared = np.bincount(parts.ravel(), (core & likely).ravel(), count)
    shared[0] = 0.0
    strange = likely & ~(shared > 0.1 * max(float(shared.max()), 1.0))[parts]
    return np.where(strange, np.float32(0.2) * probability, probability)


def _close_holes(probability: NDArray[np.float32], hidden: NDArray[np.bool_]) -> NDArray[np.float32]:
    """Fills small holes where no sky lies behind: there they are shadows, not gaps.

    A hole of less than three hundredths of the tree counts as small.
    """
    likely = probability > 0.5
    holes = ~likely & hidden
    count, parts, boxes, _ = cv2.connectedComponentsWithStats(holes.astype(np.uint8), connectivity=4)
    edge = cv2.dilate((~likely & ~hidden).astype(np.uint8), np.ones((3, 3), np.uint8)) > 0
    edge[[0, -1]] = edge[:, [0, -1]] = True
    small = boxes[:, cv2.CC_STAT_AREA] < 0.03 * likely.sum()
    small[np.unique(parts[edge])] = False
    small[0] = False
    filled: NDArray[np.float32] = np.where(small[parts], np.float32(0.9), probability)
    return filled if count > 1 else probability
