"""The automatic part of matting: a first alpha, and how far it can be trusted."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from flowtree import check
from flowtree.geometry.solve_symmetric import solve_symmetric
from flowtree.matting.describe_pixels import describe_pixels
from flowtree.matting.find_crown import Crown, find_crown
from flowtree.matting.find_sky import FAR, NEAR, Sky, find_sky
from flowtree.matting.fit_local_gaussian import fit_local_gaussian
from flowtree.matting.label_tree import CERTAIN, label_tree
from flowtree.matting.prepare_photo import PreparedPhoto
from flowtree.matting.release_sky import release_sky
from flowtree.matting.solve_alpha import KNOWN
from flowtree.matting.trace_trunk import Trunk, trace_trunk

TREE, BACKGROUND, OCCLUDER, UNKNOWN = 1, 2, 3, 4  # labels of scribbles
# Confidences: an estimate, an edge of the trunk, a gap in the crown, almost certain.
_WEAK, _OPEN, _GAP, _FIRM = 0.02, 0.01, 0.2, 5.0
_TOLD_APART = 10.0  # squared standard deviations between tree and sky from which on a gap is trusted
_REMEDY = "scribble on the tree and beside it, or pick their colours"
_BELOW = 0.15  # how far below the horizon the crown's outline is trusted [heights]
_CLEAR = 0.02  # of the height: so far above the horizon a trunk must stand free
_MOSTLY = 0.75  # share of rows that are most of them
_NOISE = 3.0  # of tree and sky colours when a pixel is split between them [CIELAB]


def guess_alpha(
    prepared: PreparedPhoto, *, scribbles: NDArray[np.uint8] | None = None
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Estimates alpha from colours, texture and place alone (Particle Flows, section 4, made automatic).

    Sky first (`find_sky`), then what stands before it in the middle (`find_crown`), then what of the ground
    and the background belongs to it (`label_tree`), and the trunk by its edges (`trace_trunk`). A pixel of
    the tree with sky behind it is split between the local colours of both, so that gaps in the crown stay
    open.

    Args:
        prepared: the photo, its small picture of h x w pixels.
        scribbles: (h, w), 0 nothing, 1 tree, 2 background, 3 an occluder, 4 unknown.

    Returns: alpha and confidence, both (h, w), as `solve_alpha` takes them.

    Raises:
        InputError: no tree can be told from the rest.
    """
    name, lab, texture, sky = prepared.photo.name, prepared.lab, prepared.texture, prepared.sky
    evidence, taken = prepared.picked, np.zeros(texture.shape, np.float32)
    if scribbles is not None:
        evidence = np.select([scribbles == TREE, scribbles == BACKGROUND], [CERTAIN, -CERTAIN], evidence)
        if sky.colors is None and (evidence < -3.0).any():
            sky = find_sky(lab, texture, evidence < -3.0)
        sky, taken = release_sky(lab, sky, scribbles == TREE)
    looks = describe_pixels(lab, texture, sky.mask, sky.distance)
    claimed = evidence > 3.0
    sky = Sky(sky.mask & ~claimed, np.where(claimed, 99.0, sky.distance).astype(np.float32), sky.colors)
    crown = find_crown((sky.distance > FAR) & ~sky.mask, sky.mask, claimed if claimed.any() else None)
    guessed = crown is None
    if crown is None:
        crown = _assume_centre(name, texture, sky)
    tree = label_tree(looks, sky.mask, crown, evidence, below=0.0, rounds=2)
    trunk = trace_trunk(prepared.bands, tree > 0.5, centre=crown.centre, width=crown.width)
    if trunk is not None and scribbles is not None:
        trunk = _stop_trunk(trunk, scribbles == BACKGROUND)
    if trunk is not None:
        said = np.abs(evidence) >= CERTAIN
        evidence = np.where(said, evidence, evidence + _beside_trunk(trunk, tree, crown))
    # Where the free trunk begins is known now: above it, the crown may be trusted to go on below the horizon.
    tree = label_tree(looks, sky.mask, crown, evidence, below=_BELOW, rounds=2)
    check.require(
        not guessed or _differs(np.dstack([lab, texture]), tree),
        name,
        "must show a tree that differs from what surrounds it",
        "one thing all over",
        _REMEDY,
    )
    alpha, confidence = _split(lab, sky, tree, crown, taken)
    if trunk is not None:
        _draw_trunk(alpha, confidence, trunk, crown)
    if scribbles is not None:
        for label, value in ((TREE, 1.0), (BACKGROUND, 0.0)):
            alpha[scribbles == label] = value
            confidence[scribbles == label] = KNOWN
        confidence[scribbles >= OCCLUDER] = _OPEN
    share = float(alpha.mean())
    check.require(share > 0.001, name, "must show a tree", "no tree found", _REMEDY)
    check.require(share < 0.98, name, "must show something beside the tree", "one thing all over", _REMEDY)
    return alpha, confidence


def _stop_trunk(trunk: Trunk, background: NDArray[np.bool_]) -> Trunk | None:
    """The trunk down to the first row where a scribble crosses it: its reflection, or a post under it."""
    crossed = [
        bool(background[row, max(0, x - half) : x + half + 1].any())
        for row, x, half in zip(trunk.rows, trunk.centre, trunk.half, strict=True)
    ]
    end = crossed.index(True) if any(crossed) else len(crossed)
    if end == 0:
        return None
    return Trunk(trunk.rows[:end], trunk.centre[:end], trunk.half[:end], trunk.contrast[:end])


def _assume_centre(name: str, texture: NDArray[np.float32], sky: Sky) -> Crown:
    """Without a crown before the sky the tree is looked for in the middle of the picture."""
    height, width = texture.shape
    rows, columns = np.mgrid[:height, :width]
    away = np.hypot((rows - 0.45 * height) / (0.3 * height), (columns - 0.5 * width) / (0.25 * width))
    core = (away < 1.0) & ~sky.mask & (texture > 3.0)
    check.require(
        core.sum() > 0.002 * height * width,
        name,
        "must show a tree",
        "no tree found",
        _REMEDY,
    )
    side = 0.35 * width
    left, right = np.full(height, 0.5 * width - side), np.full(height, 0.5 * width + side)
    return Crown(core, np.full(width, 0.3 * height), left, right, 0.5 * width, 2.0 * side)


def _differs(features: NDArray[np.float32], tree: NDArray[np.float32]) -> bool:
    """Whether any feature's mean differs by half a standard deviation between tree and rest."""
    likely = tree > 0.5
    if likely.all() or not likely.any():
        return False
    front, rest = features[likely], features[~likely]
    spread = np.sqrt(0.5 * (front.var(axis=0) + rest.var(axis=0))) + 1.0
    return bool((np.abs(front.mean(axis=0) - rest.mean(axis=0)) > 0.5 * spread).any())


def _beside_trunk(trunk: Trunk, tree: NDArray[np.float32], crown: Crown) -> NDArray[np.float32]:
    """Log-odds against everything beside a trunk that stands free: there the crown has ended."""
    height, width = tree.shape
    free, hidden = np.zeros((2, len(trunk.rows)), bool)
    for at, (row, x, half) in enumerate(zip(trunk.rows, trunk.centre, trunk.half, strict=True)):
        flanks = [
            tree[row, max(0, x - 3 * half) : max(0, x - half)],
            tree[row, x + half + 1 : x + 3 * half + 1],
        ]
        beside = max((float(flank.mean()) for flank in flanks if flank.size), default=1.0)
        hidden[at] = row > crown.horizon[min(max(x, 0), width - 1)]
        free[at] = trunk.contrast[at] > 0.0 and beside < 0.5
    shown = np.flatnonzero(~hidden)[-max(3, round(_CLEAR * height)) :]
    if len(shown) and free[shown].mean() >= _MOSTLY:
        free[shown[-1] :] = True  # with sky on both sides at the horizon it has no crown below
    free &= hidden
    against = np.zeros((height, width), np.float32)
    # The free stretch begins where most rows from there on are free.
    share = np.cumsum(free[::-1])[::-1] / np.arange(len(free), 0, -1)
    begin = np.flatnonzero((share >= _MOSTLY) & free)
    if len(begin) == 0:
        return against
    first = int(trunk.rows[begin[0]])
    rows, columns = np.mgrid[:height, :width]
    against -= (3.0 * np.clip((rows - first) / (0.05 * height), 0.0, 1.0)).astype(np.float32)
    # Above, the crown opens like a bowl: hedges are level with its rim, not below it.
    aside = np.abs(columns - trunk.centre[begin[0]])
    below_rim = aside > 0.25 * crown.width + 1.5 * np.maximum(first - rows, 0)
    against[below_rim & (rows < first) & (rows > crown.horizon[None, :])] -= 4.0
    for row, x, half in zip(trunk.rows, trunk.centre, trunk.half, strict=True):
        against[row, max(0, x - half) : x + half + 1] = 0.0
    return against


def _split(
    lab: NDArray[np.float32],
    sky: Sky,
    tree: NDArray[np.float32],
    crown: Crown,
    taken: NDArray[np.float32],
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Alpha and confidence from the labels and, where sky is near, from the colours of tree and sky."""
    likely = tree > 0.5
    # Where no sky shines through, a pixel is tree or is not; doubts are those of the label, not a density.
    alpha = np.clip((tree - 0.4) / 0.4, 0.0, 1.0)
    told_apart = np.zeros_like(likely)
    if sky.colors is not None:
        solid = (likely & (sky.distance > 8.0)).astype(np.float32)
        colors = fit_local_gaussian(lab, solid)
        # Fisher's direction: lights and shadows among the leaves count less than what tells leaf from sky.
        apart = colors.mean - sky.colors.mean
        spread = colors.floored(_NOISE) + sky.colors.floored(_NOISE)
        direction = solve_symmetric(spread, apart)
        length = np.maximum(np.einsum("ijk,ijk->ij", apart, direction), 1e-3)
        along = np.clip(np.einsum("ijk,ijk->ij", lab - sky.colors.mean, direction) / length, 0.0, 1.0)
        along += (1.0 - along) * taken
        reach = 2 * max(4, round(0.02 * max(tree.shape))) + 1
        near_sky = cv2.blur(sky.mask.astype(np.float32), (reach, reach)) > 0.0
        near_sky |= np.arange(len(tree))[:, None] < crown.horizon[None, :]
        alpha = np.where(near_sky, along, alpha).astype(np.float32)
        told_apart = near_sky & (length > _TOLD_APART)
    touched = cv2.dilate(likely.astype(np.uint8), np.ones((5, 5), np.uint8)) > 0
    alpha[~touched] = 0.0
    clear = sky.mask & (sky.distance < NEAR)
    # Smoothness would close a gap that has nothing but tree around it.
    alone = cv2.dilate(clear.astype(np.uint8), np.ones((7, 7), np.uint8)) == 0
    gap = told_apart & alone & (alpha < 0.5)
    confidence = np.where(gap, np.float32(_GAP), np.float32(_WEAK))
    other = cv2.erode((tree < 0.1).astype(np.uint8), np.ones((7, 7), np.uint8)) > 0
    nothing = clear | other | ~touched
    alpha[nothing], confidence[nothing] = 0.0, KNOWN
    open_ = cv2.blur(sky.mask.astype(np.float32), (3, 3)) > 0.0
    sure = likely & (tree > 0.9) & (alpha > 0.85) & ~open_
    alpha[sure], confidence[sure] = 1.0, _FIRM
    return alpha, confidence


def _draw_trunk(
    alpha: NDArray[np.float32], confidence: NDArray[np.float32], trunk: Trunk, crown: Crown
) -> None:
    """Below the horizon: tree inside the band, unknown at its edges."""
    width = alpha.shape[1]
    for row, x, half in zip(trunk.rows, trunk.centre, trunk.half, strict=True):
        if row <= crown.horizon[min(max(x, 0), width - 1)]:
            continue
        edge = slice(max(0, int(x - 1.5 * half) - 1), int(x + 1.5 * half) + 2)
        inner = slice(max(0, int(x - 0.6 * half)), int(x + 0.6 * half) + 1)
        confidence[row, edge] = np.where(confidence[row, edge] >= KNOWN, _OPEN, confidence[row, edge])
        alpha[row, inner], confidence[row, inner] = 1.0, _FIRM
