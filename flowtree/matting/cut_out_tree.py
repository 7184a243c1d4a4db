"""From a photograph to the alpha of its tree."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import ArrayLike, NDArray

from flowtree import check
from flowtree.matting.drop_strangers import drop_strangers
from flowtree.matting.estimate_foreground import estimate_foreground
from flowtree.matting.fill_occluded import fill_occluded
from flowtree.matting.guess_alpha import BACKGROUND, OCCLUDER, TREE, UNKNOWN, guess_alpha
from flowtree.matting.prepare_photo import PreparedPhoto, prepare_photo, scale_down
from flowtree.matting.refine_alpha import refine_alpha
from flowtree.matting.solve_alpha import KNOWN, solve_alpha
from flowtree.model.photo import Photo
from flowtree.params import MattingParams

_UNSURE = 1e-3  # confidence of an unknown pixel of a trimap
_FAINT, _FULL = 0.02, 0.98  # beyond these alpha is 0 or 1: the eye sees no difference, the density does


@dataclass(frozen=True)
class CutOut:
    """A tree cut out, but not yet with its own colours.

    Attributes:
        alpha: (h, w) float32 in 0..1.
        method: as of a `Matte`.
        occluded: (h, w) bool, where something stands before the tree; None where nothing does.
    """

    alpha: NDArray[np.float32]
    method: str
    occluded: NDArray[np.bool_] | None = None


def cut_out_tree(
    photo: Photo,
    *,
    trimap: ArrayLike | None = None,
    scribbles: ArrayLike | None = None,
    prepared: PreparedPhoto | None = None,
    params: MattingParams = MattingParams(),
) -> CutOut:
    """Cuts the tree out (Particle Flows, section 4): alpha is the density estimate of the view.

    A photo with an alpha channel is its own matte. Else a trimap decides; else the tree is found
    automatically (`guess_alpha`), steered by picked colours and scribbles. Unlike the paper, which has the
    user select colours for a trimap, nothing need be given. Closed-form matting is solved at
    ``params.solve_height`` on the tree's box and carried to the full size by a guided filter, so that twigs
    and gaps stay sharp.

    Args:
        photo: with h x w pixels.
        trimap: (h, w): 0 background, 255 tree, between unknown.
        scribbles: (h, w): 0 nothing, 1 tree, 2 background, 3 something that stands before the tree: there
            the matte's ``unknown`` is set, 4 where the pixels shall decide and no judgement. Beside a trimap
            or an alpha channel only the 3 counts.
        prepared: what `prepare_photo` found out about this photo with these parameters; left out, it is found
            out anew. Whoever makes several mattes of one photo, one after every scribble, keeps it.
        params: picked colours, and the size to solve at.

    Raises:
        InputError: no tree found, tree all over, an empty alpha channel, a trimap without tree or background,
            an array of another size than the photo, ``prepared`` from another photo or other parameters.
    """
    shape = photo.rgb.shape[:2]
    labels = None
    if scribbles is not None:
        labels = check.array(scribbles, "scribbles", shape=shape, dtype=np.uint8, low=0, high=UNKNOWN)
    if photo.alpha is not None:
        seen = bool((photo.alpha > 0.5).any())
        check.require(
            seen, photo.name, "needs a tree in its alpha channel", "an empty one", "cut it out again"
        )
        return _hide(photo.alpha, "alpha channel", labels)
    if trimap is not None:
        known = check.array(trimap, "trimap", shape=shape, dtype=np.uint8, low=0, high=255)
        for value, what in ((0, "background (0)"), (255, "tree (255)")):
            found = bool((known == value).any())
            check.require(found, "trimap", f"needs some {what}", "none", "mark some of it")
        alpha = _solve_trimap(photo.rgb, known, params.solve_height)
        alpha[known == 0], alpha[known == 255] = 0.0, 1.0
        return _finish(photo, alpha, "trimap", labels)
    if prepared is None:
        prepared = prepare_photo(photo, params=params)
    fits = prepared.photo is photo and prepared.params == params
    check.require(
        fits,
        "prepared photo",
        f"must be made of {photo.name} with the same parameters",
        f"that of {prepared.photo.name}",
        "call prepare_photo again",
    )
    small = prepared.small
    marks = None if labels is None else _shrunk_labels(labels, small.shape[:2])
    prior, confidence = guess_alpha(prepared, scribbles=marks)
    alpha = refine_alpha(small, _solve_box(small, prior, confidence), photo.rgb)
    alpha = drop_strangers(alpha, None if labels is None else labels == TREE)
    if labels is not None:
        alpha[labels == TREE], alpha[labels == BACKGROUND] = 1.0, 0.0
    return _finish(photo, alpha, "automatic" if labels is None else "scribbles", labels)


def _finish(
    photo: Photo, alpha: NDArray[np.float32], method: str, labels: NDArray[np.uint8] | None
) -> CutOut:
    stretched = np.clip((alpha - _FAINT) / (_FULL - _FAINT), 0.0, 1.0).astype(np.float32)
    check.require(
        bool((stretched > 0.5).any()),
        photo.name,
        "must show a tree",
        "no tree found",
        "scribble on the tree and beside it, or pick their colours",
    )
    return _hide(stretched, method, labels)


def _hide(alpha: NDArray[np.float32], method: str, labels: NDArray[np.uint8] | None) -> CutOut:
    """What stands before the tree hides it: there alpha is a guess from around."""
    occluded = None if labels is None else labels == OCCLUDER
    if occluded is None or not occluded.any():
        return CutOut(alpha, method)
    return CutOut(fill_occluded(alpha, occluded), method, occluded)


def _solve_box(
    small: NDArray[np.uint8], prior: NDArray[np.float32], confidence: NDArray[np.float32]
) -> NDArray[np.float32]:
    """Solves on the box around everything that may be tree; beside it alpha is 0."""
    rows, columns = np.nonzero((prior > 0.01) | (confidence < KNOWN))
    alpha = np.zeros_like(prior)
    if len(rows):
        box = (
            slice(max(0, int(rows.min()) - 4), int(rows.max()) + 5),
            slice(max(0, int(columns.min()) - 4), int(columns.max()) + 5),
        )
        alpha[box] = solve_alpha(small[box], prior[box], confidence[box])
    return alpha


def _solve_trimap(rgb: NDArray[np.uint8], trimap: NDArray[np.uint8], side: int) -> NDArray[np.float32]:
    small = scale_down(rgb, side)
    size = (small.shape[1], small.shape[0])
    level = np.where(trimap == 0, 0.0, np.where(trimap == 255, 1.0, 0.5)).astype(np.float32)
    level = cv2.resize(level, size, interpolation=cv2.INTER_AREA).astype(np.float32)
    known = (level < 1e-3) | (level > 1.0 - 1e-3)
    confidence = np.where(known, KNOWN, _UNSURE).astype(np.float32)
    prior = np.where(known, np.rint(level), _nearest_color(small, level)).astype(np.float32)
    return refine_alpha(small, _solve_box(small, prior, confidence), rgb)


def _nearest_color(rgb: NDArray[np.uint8], level: NDArray[np.float32]) -> NDArray[np.float32]:
    """A weak estimate for the unknown: between the mean colours of tree and background near the pixel."""
    image = rgb.astype(np.float32) / np.float32(255.0)
    front = estimate_foreground(rgb, (level > 0.999).astype(np.float32)).astype(np.float32) / 255.0
    back = estimate_foreground(rgb, (level < 0.001).astype(np.float32)).astype(np.float32) / 255.0
    apart = front - back
    along = ((image - back) * apart).sum(axis=2) / np.maximum((apart**2).sum(axis=2), 1e-3)
    estimate: NDArray[np.float32] = np.clip(along, 0.0, 1.0).astype(np.float32)
    return estimate


def _shrunk_labels(labels: NDArray[np.uint8], shape: tuple[int, ...]) -> NDArray[np.uint8]:
    """Labels at the small size: the one that covers most of a pixel, where any covers a sixteenth."""
    size = (shape[1], shape[0])
    small, most = np.zeros(shape, np.uint8), np.zeros(shape, np.float32)
    for label in (TREE, BACKGROUND, OCCLUDER, UNKNOWN):
        here = labels == label
        if here.any():
            cover = cv2.resize(here.astype(np.float32), size, interpolation=cv2.INTER_AREA)
            small[cover > most] = label
            most = np.maximum(most, cover)
    small[most < 1.0 / 16.0] = 0
    return small
