"""Does the tree bear leaves, or is it bare?"""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from flowtree.model.camera import Camera
from flowtree.model.matte import Matte

_HEIGHT = 512  # of the tree in the picture that is looked at [pixels]
_COHERENCE = 0.48  # twigs are lines: of the test trees bare ones have 0.51 and more, broad crowns 0.4 to 0.65
_MASSIVE = 0.65  # leaves gather in masses: 0.7 and more survive an opening by 1 % of the height, of twigs 0.6
_CHROMA = 9.0  # twigs have the trunk's colour [CIELAB]: under 8; a crown as open, but of leaves, over 20


def judge_leafy(mattes: Sequence[Matte], cameras: Sequence[Camera]) -> bool:
    """Whether most views show leaves.

    A tree is bare where its crown is made of lines (coherent edges), without masses, in the colour of its
    trunk; all three must hold, for conifers have fine lines and a silhouette at dusk has but one colour.

    Args:
        mattes: one a view, with the foreground's colours.
        cameras: theirs.

    Returns: true without any view, and false where as many views show leaves as do not.
    """
    bare = sum(_is_bare(matte, camera) for matte, camera in zip(mattes, cameras, strict=True))
    return 2 * bare < len(mattes) or not len(mattes)


def _is_bare(matte: Matte, camera: Camera) -> bool:
    rows = np.flatnonzero((matte.alpha > 0.3).sum(axis=1) > 1)
    if len(rows) < 16:
        return False
    size = min(1.0, _HEIGHT / len(rows))
    alpha = np.asarray(
        cv2.resize(matte.alpha, None, fx=size, fy=size, interpolation=cv2.INTER_AREA), np.float32
    )
    top, foot = rows[0] * size, min(rows[-1] * size, camera.foot[1] * size)
    height = np.arange(alpha.shape[0])
    crown = (height >= top) & (height < foot - 0.35 * (foot - top))
    trunk = (height >= foot - 0.12 * (foot - top)) & (height < foot - 0.006 * (foot - top))
    return (
        _coherence(alpha) > _COHERENCE
        and _massive(alpha) < _MASSIVE
        and _chroma_gap(matte, size, alpha, crown, trunk) < _CHROMA
    )


def _coherence(alpha: NDArray[np.float32]) -> float:
    """How much the edges of a neighbourhood agree in direction: 0 not at all, 1 straight lines."""
    soft = cv2.GaussianBlur(alpha, (0, 0), 1.0)
    down, right = np.gradient(soft)
    xx, yy, xy = (cv2.GaussianBlur(t, (0, 0), 3.0) for t in (right * right, down * down, right * down))
    return float(np.hypot(xx - yy, 2 * xy).sum() / max(float((xx + yy).sum()), 1e-9))


def _massive(alpha: NDArray[np.float32]) -> float:
    """Share of the alpha that survives an opening by a disc of 1 % of ``_HEIGHT``.

    The disc is as large in a smaller picture, whose twigs are as wide as its pixels.
    """
    radius = max(1, round(0.01 * _HEIGHT))
    disc = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * radius + 1, 2 * radius + 1))
    return float(cv2.morphologyEx(alpha, cv2.MORPH_OPEN, disc).sum() / max(float(alpha.sum()), 1e-9))


def _chroma_gap(
    matte: Matte, size: float, alpha: NDArray[np.float32], crown: NDArray[np.bool_], trunk: NDArray[np.bool_]
) -> float:
    """Distance in CIELAB's a, b between the medians of crown and trunk; 0 where one cannot be seen."""
    small = cv2.resize(matte.foreground, None, fx=size, fy=size, interpolation=cv2.INTER_AREA)
    lab = cv2.cvtColor(small.astype(np.float32) / 255, cv2.COLOR_RGB2LAB)
    solid = alpha > 0.8
    seen = [lab[solid & rows[:, None]] for rows in (crown, trunk)]
    if min(len(s) for s in seen) < 16:
        return 0.0
    gap = np.median(seen[0], axis=0) - np.median(seen[1], axis=0)
    return float(np.hypot(gap[1], gap[2]))
