"""Tells the tree from hedges, lawns and other trees where no sky lies behind it."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import cv2
import numpy as np
from numpy.typing import NDArray

from flowtree.matting.cut_regions import cut_regions
from flowtree.matting.describe_pixels import Looks, count_colors, halve
from flowtree.matting.find_crown import Crown
from flowtree.matting.rate_likeness import Window, rate_likeness

CERTAIN = 8.0  # log-odds of what the user said
_NOISE, _TEXTURE_NOISE = 4.0, 0.2  # of local colours [CIELAB] and of the logarithm of texture
_BORDER = 3.5  # price of a border [log-odds a pixel of half the size]
_ROUNDS = 120  # of the cut
_COLOUR, _SHARES, _TEXTURE = 2.5, 3.0, 2.0  # what colours here, colours at all and texture may say at most
_TEXTURE_SAYS = 0.3
_ENCLOSED = 2.0  # log-odds of a pixel with tree on all four sides; half of it on three
_LEARNED = 0.5  # weight of what was labelled beside what was known
_CROWN = 1.5  # log-odds that what stands before the sky in the middle is the tree
_RIM = 0.012  # of the larger side: width of an edge whose colours are mixed with the sky's
_SPOKEN = 8.0  # weight of a scribbled pixel among those that teach a model


def label_tree(
    looks: Looks,
    sky: NDArray[np.bool_],
    crown: Crown,
    evidence: NDArray[np.float32],
    *,
    below: float,
    rounds: int,
) -> NDArray[np.float32]:
    """Probability (h, w) that a pixel that is no sky belongs to the tree.

    The crown before the sky teaches what the tree looks like, the ground beside and below it what the rest
    looks like. What lies behind a tree is layered: a hedge, a lake or a road looks the same along its rows,
    so the rest is looked for near the pixel, in its rows, and all over (`rate_likeness`). The log-odds of
    colour and texture join with where a tree can be (the outline of the crown continued downwards), and a
    minimal cut (`cut_regions`) finds the region, its border short and along edges. Both models are learned
    again from the result. Ground that looks more like the crown than like other ground teaches little, for
    the tree may reach out further than its outline before the sky tells; so does what looks like ground in
    the crown: a roof or another tree behind it.

    Args:
        looks: of the picture.
        sky: (h, w).
        crown: what shows before the sky.
        evidence: (h, w) log-odds known beforehand: scribbles, picked colours, rows beside a visible trunk.
        below: how far under the horizon the inside of the crown's outline is taken for tree [heights].
        rounds: how often the models are learned.
    """
    height, width = sky.shape
    solid = ~sky
    deep = np.arange(height)[:, None] - crown.horizon[None, :]
    place, outside = _place_prior(sky, crown)
    prior = place + evidence
    taught = (prior > 1.0).astype(np.float32)
    taught[(prior > 0.5) & (deep > 0.0) & (deep < below * height)] = 0.3
    taught[evidence >= CERTAIN] = _SPOKEN
    taught *= solid
    other = (((outside & ~crown.core & (evidence < 1.0)) | (evidence < -1.0)) & solid).astype(np.float32)
    alike = _shares_ratio(looks, taught * looks.unmixed, other)
    sure = np.float32(_CROWN)  # a roof before the sky teaches little, where the rest of the crown is no roof
    silent = evidence <= 1.0
    taught = np.where(silent, taught / (1.0 + np.exp(-sure - alike)), taught).astype(np.float32)
    other = np.where(evidence < -1.0, other, other / (1.0 + np.exp(alike))).astype(np.float32)
    other[(evidence <= -CERTAIN) & solid] = _SPOKEN
    share, coarse_prior = halve(solid), halve(prior)
    size, line = float(max(share.shape)), float(share.shape[0])
    near, wide = Window(0.06 * size, 0.06 * size, 1.0), Window(0.16 * size, 0.16 * size, 0.3)
    rows = Window(0.35 * share.shape[1], 0.02 * line, 1.0)
    hidden = deep > 0.0
    tree, rest = taught, other
    label = np.zeros_like(share)
    for _ in range(rounds):
        mine, theirs = tree * looks.unmixed, rest * looks.unmixed
        with ThreadPoolExecutor(1) as beside:  # somebody waits for the matte, and the other core is idle
            strange = beside.submit(
                rate_likeness, looks.color, halve(theirs), (near, rows, wide), noise=_NOISE
            )
            colour = rate_likeness(looks.color, halve(mine), (near, wide), noise=_NOISE)
            shares = _shares_ratio(looks, mine, theirs)
            shares = halve(np.clip(shares, -_SHARES, _SHARES) * looks.unmixed) / halve(looks.unmixed)
            texture = _texture_odds(looks, tree * hidden, rest, wide, (near, rows, wide))
            colour -= strange.result()
        odds = np.clip(colour, -_COLOUR, _COLOUR) + shares
        odds += _TEXTURE_SAYS * texture
        odds = odds * share + coarse_prior
        odds = odds + _enclosed(label)
        odds = np.where(share < 0.3, 0.0, np.clip(odds, -6.0, 6.0)).astype(np.float32)
        label = cut_regions(odds, _BORDER * looks.cost_right, _BORDER * looks.cost_down, rounds=_ROUNDS)
        full = cv2.resize(label, (width, height))
        tree = np.maximum(_LEARNED * np.where(full > 0.6, full, 0.0), taught * (full > 0.3)) * solid
        rest = np.maximum(_LEARNED * np.where(full < 0.1, 1.0 - full, 0.0), other * (full < 0.7)) * solid
        tree, rest = tree.astype(np.float32), rest.astype(np.float32)
    probability: NDArray[np.float32] = cv2.resize(label, (width, height)).astype(np.float32)
    probability[sky] = 0.0
    inner = _follow_inside(probability, solid, crown)
    return _close_holes(_keep_connected(inner, crown.core), solid & hidden)


def _place_prior(sky: NDArray[np.bool_], crown: Crown) -> tuple[NDArray[np.float32], NDArray[np.bool_]]:
    """Log-odds from the place alone, and the ground that no crown reaches."""
    height, width = sky.shape
    rows, columns = np.mgrid[:height, :width].astype(np.float32)
    inside = np.minimum(columns - crown.left[:, None], crown.right[:, None] - columns) / crown.width
    depth = (rows - crown.horizon[None, :]) / height
    # The deeper below the horizon, the vaguer is what the outline above it foretells.
    prior = np.clip(inside / (0.1 + 0.3 * np.maximum(depth, 0.0)), -3.0, 0.8)
    prior = prior - 0.4 * np.clip(depth / 0.3 - 0.1, 0.0, 3.0)
    prior -= 3.0 * (rows > 0.93 * height)
    # What stands before the sky far from the middle may be a neighbour that touches the crown.
    central = np.exp(-(((columns - crown.centre) / (0.6 * crown.width)) ** 2))
    prior[crown.core] = (0.8 + 2.2 * central)[crown.core]
    other = ~sky & (depth < -0.03) & ~crown.core
    prior[other] = np.minimum(prior[other], -1.0)
    place: NDArray[np.float32] = prior.astype(np.float32)
    outside = (depth > 0.0) & ((inside < -0.25) | (rows > 0.9 * height))
    return place, outside


def _shares_ratio(looks: Looks, tree: NDArray[np.float32], rest: NDArray[np.float32]) -> NDArray[np.float32]:
    """Log-ratio (h, w) of the colours' shares in the whole picture."""
    least = np.float32(1e-5)
    ratio = np.log((count_colors(looks.cells, tree) + least) / (count_colors(looks.cells, rest) + least))
    spread: NDArray[np.float32] = ratio[looks.cells]
    return spread


def _texture_odds(
    looks: Looks,
    tree: NDArray[np.float32],
    rest: NDArray[np.float32],
    wide: Window,
    windows: tuple[Window, ...],
) -> NDArray[np.float32]:
    """Log-odds (r, c) from the roughness; nothing where sky is near, for there all is rough."""
    texture, some = looks.texture[..., None], np.float32(1e-3)
    odds = rate_likeness(texture, (halve(tree) + some) * looks.clear, (wide,), noise=_TEXTURE_NOISE)
    odds -= rate_likeness(texture, (halve(rest) + some) * looks.clear, windows, noise=_TEXTURE_NOISE)
    return np.clip(odds, -_TEXTURE, _TEXTURE) * looks.clear


def _enclosed(label: NDArray[np.float32]) -> NDArray[np.float32]:
    """Log-odds (r, c) for pixels that have tree above, below, left and right of them."""
    tree = label > 0.5
    sides = sum(
        (
            np.maximum.accumulate(tree, axis=1).astype(np.int8),
            np.maximum.accumulate(tree[:, ::-1], axis=1)[:, ::-1],
            np.maximum.accumulate(tree, axis=0),
            np.maximum.accumulate(tree[::-1], axis=0)[::-1],
        )
    )
    odds: NDArray[np.float32] = np.select([sides == 4, sides == 3], [_ENCLOSED, 0.5 * _ENCLOSED], 0.0)
    return odds.astype(np.float32)


def _follow_inside(
    probability: NDArray[np.float32], solid: NDArray[np.bool_], crown: Crown
) -> NDArray[np.float32]:
    """Doubts the rim before the sky of something wide that itself is no tree: a neighbour, a roof.

    Colours at an edge are mixed with the sky's, and look like those of the crown's own edge.
    """
    reach = max(2, round(_RIM * max(solid.shape)))
    brush = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * reach + 1, 2 * reach + 1))
    inside = cv2.erode(solid.astype(np.uint8), brush) > 0
    other, tree = (
        cv2.distanceTransform(1 - (inside & there).astype(np.uint8), cv2.DIST_L2, 5)
        for there in (probability < 0.5, probability >= 0.5)
    )
    strange = ~inside & (other < 2.0 * reach) & (other < tree)
    return np.where(strange, np.float32(0.2) * probability, probability)


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
