"""Which way a tree's branches grow, as its pictures show it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import cv2
import numpy as np
from numpy.typing import NDArray

from flowtree.model.attractor import Habit
from flowtree.model.camera import Camera
from flowtree.model.matte import Matte
from flowtree.params import AttractionParams

_HEIGHT = 320  # of the tree in the picture that is looked at [pixels]
_BANDS = 20  # of the height, whose widths are the silhouette
_BARE_STEM = 0.55  # a palm's stem is at least this share of its height
_SLIM = 0.9  # a conifer is at most this wide for its height
_STEM = 0.25  # of the widest band: as narrow as this it is a stem
_LOW = 0.25  # of the height: a conifer's crown begins below
_OUTER = 0.45  # of the half width: farther out branches show their habit
_LEAST = 0.01  # of the crown's pixels must be lines for them to count
_COHERENT = 0.6  # how much the edges of a neighbourhood agree in direction where there is a line
_HANGS, _RISES = -0.3, 0.75  # mean sine of the elevation below which branches hang, above which they stand


def judge_habit(
    mattes: Sequence[Matte],
    cameras: Sequence[Camera],
    *,
    leafy: bool = True,
    params: AttractionParams = AttractionParams(),
) -> Habit:
    """The habit most views show, or the one that is given.

    The silhouette tells a palm (a tuft on a long bare stem) and a conifer (a slim cone from near the ground).
    Else the lines in the outer crown of a bare tree tell which way its branches go from the stem outwards: up
    and steeply so, down, or neither. A leafy crown that is no palm and no conifer is taken as spreading.

    Args:
        mattes: one a view.
        cameras: theirs.
        leafy: whether the tree bears leaves.
        params: its ``habit`` counts where it is not "auto".
    """
    if params.habit != "auto":
        return params.habit
    found = [_habit(matte, camera, leafy) for matte, camera in zip(mattes, cameras, strict=True)]
    order: tuple[Habit, ...] = ("palm", "conifer", "weeping", "upright")
    for habit in order:
        if 2 * found.count(habit) > len(found):
            return habit
    return "spreading"


def _habit(matte: Matte, camera: Camera, leafy: bool) -> Habit:
    rows = np.flatnonzero((matte.alpha > 0.3).sum(axis=1) > 1)
    foot = min(int(camera.foot[1]), matte.alpha.shape[0])
    rows = rows[rows < foot]
    if len(rows) < _BANDS:
        return "spreading"
    alpha = matte.alpha[rows[0] : foot]
    profile = _profile(alpha)
    if profile is not None:
        return profile
    if leafy:
        return "spreading"
    scale = min(1.0, _HEIGHT / len(alpha))
    small = cv2.resize(alpha, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
    rise = _mean_rise(np.asarray(small, np.float32), camera.foot[0] * scale)
    return "weeping" if rise < _HANGS else "upright" if rise > _RISES else "spreading"


def _profile(alpha: NDArray[np.float32]) -> Literal["palm", "conifer"] | None:
    """What the widths from top to foot tell."""
    solid = alpha > 0.3
    width = np.array([float(np.mean(band.sum(axis=1))) for band in np.array_split(solid, _BANDS)]) / len(
        solid
    )
    widest = float(width.max())
    stem = width < _STEM * widest
    bare = int(np.argmin(stem[::-1]))  # bands from the ground up
    if bare >= _BARE_STEM * _BANDS:
        return "palm"
    crown = width[: _BANDS - bare]
    slope = float(np.polyfit(np.linspace(0.0, 1.0, len(crown)), crown / widest, 1)[0])
    cone = slope > 0.6 and crown[0] < _STEM * widest and int(np.argmax(crown)) >= 0.6 * len(crown)
    return "conifer" if cone and bare <= _LOW * _BANDS and widest < _SLIM else None


def _mean_rise(alpha: NDArray[np.float32], foot: float) -> float:
    """Mean sine of the elevation of the lines in the outer crown, going from the stem outwards."""
    soft = cv2.GaussianBlur(alpha, (0, 0), 1.0)
    down, right = np.gradient(soft)
    xx, yy, xy = (cv2.GaussianBlur(t, (0, 0), 2.0) for t in (right * right, down * down, right * down))
    apart = np.hypot(xx - yy, 2.0 * xy)
    coherent = apart / np.maximum(xx + yy, 1e-9)
    across = 0.5 * np.arctan2(2.0 * xy, xx - yy)  # the direction across the lines, x right and y down
    x, y = -np.sin(across), np.cos(across)
    outward = np.arange(alpha.shape[1])[None, :] - foot
    tree = alpha > 0.3
    half = max(float(np.abs(np.where(tree, outward, 0.0)).max()), 1.0)
    line = tree & (coherent > _COHERENT) & (np.abs(outward) > _OUTER * half)
    if line.sum() < _LEAST * tree.sum():
        return 0.5
    rise = -y * np.sign(x * outward)  # upwards, when it goes outwards
    return float(np.average(rise[line], weights=apart[line]))
