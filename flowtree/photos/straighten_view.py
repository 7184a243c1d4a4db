"""The pictures of one view, from its photograph into the level, parallel picture of its tree."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from flowtree.model.edit import PaintedEdit
from flowtree.model.matte import Matte
from flowtree.model.photo import Photo
from flowtree.model.placement import Placement
from flowtree.photos.level_picture import pixel_centres
from flowtree.photos.place_pixels import place_pixels
from flowtree.photos.straighten_lines import move_places

_SOLID = 0.5  # alpha inside the trunk
_TOUCHES = 0.05  # mean alpha near a place on the frame's edge, from which on the tree goes on beyond it
_NOTHING = 128.0  # grey where there is no photograph
_AROUND = 0.03  # of the frame's side: near


def straighten_view(
    photo: Photo,
    matte: Matte,
    edit: PaintedEdit,
    placement: Placement,
) -> tuple[Photo, Matte, PaintedEdit]:
    """Resamples what belongs to a photograph; nothing is touched where the placement has no warp.

    Where the tree leaves the photograph at its sides or at the top, what is beyond is unknown, not empty. A
    trunk that leaves it at the bottom goes on down to the foot as wide as it was last seen.

    Args:
        photo: of the view.
        matte: of the photo.
        edit: painted on it.
        placement: of the tree in it.

    Returns: the same things in pixels of ``placement.camera``.
    """
    if placement.warp is None:
        return photo, matte, edit
    warp, camera = placement.warp, placement.camera
    size = (camera.width, camera.height)
    back = np.asarray(np.linalg.inv(warp), np.float64)
    # Pixels of the photograph per pixel of the new picture, at the foot.
    step = move_places(warp, np.array([camera.foot, (camera.foot[0] + 1.0, camera.foot[1])]))
    ratio = float(np.linalg.norm(step[1] - step[0]))

    def resample(picture: Any, border: int = cv2.BORDER_CONSTANT, value: float = 0.0) -> Any:
        if picture is None:
            return None
        if ratio > 1.3:  # several pixels fall into one
            picture = cv2.GaussianBlur(picture, (0, 0), 0.35 * ratio)
        return cv2.warpPerspective(
            picture,
            pixel_centres(warp),
            size,
            flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP,
            borderMode=border,
            borderValue=(value, value, value),
        )

    alpha, unknown = resample(matte.alpha), resample(_as_float(matte.unknown))
    beyond = _beyond(matte.alpha, placement)
    unknown = beyond if unknown is None else (unknown > 0.25) | beyond
    if "bottom" in placement.missing:
        stem = resample(_stem_at_edge(matte.alpha, placement, math.ceil(2.0 * ratio)), cv2.BORDER_REPLICATE)
        stem[math.ceil(camera.foot[1]) :] = 0.0
        alpha = np.maximum(alpha, stem)
    straight = replace(
        matte,
        alpha=np.clip(alpha, 0.0, 1.0).astype(np.float32),
        foreground=resample(matte.foreground, cv2.BORDER_REPLICATE),
        unknown=unknown if unknown.any() else None,
    )
    view = replace(
        photo,
        rgb=resample(photo.rgb, value=_NOTHING),
        alpha=resample(photo.alpha),
        scale=photo.scale / ratio,
        focal_length=None,
    )
    edited = PaintedEdit(
        add=resample(edit.add),
        erase=resample(edit.erase),
        directions=tuple(move_places(back, line).astype(np.float32) for line in edit.directions),
        reach=tuple(reach / ratio for reach in edit.reach),
    )
    return view, straight, edited


def _as_float(mask: NDArray[np.bool_] | None) -> NDArray[np.float32] | None:
    return None if mask is None else mask.astype(np.float32)


def _beyond(alpha: NDArray[np.float32], placement: Placement) -> NDArray[np.bool_]:
    """Pixels of the straightened picture beyond those places of the frame where the tree leaves it."""
    columns = alpha.shape[1]
    camera = placement.camera
    outside = np.zeros((camera.height, camera.width), bool)
    sides = [side for side in placement.missing if side != "bottom"]
    if not sides:
        return outside
    x, y = place_pixels(placement)
    for side in sides:
        edge = {"left": alpha[:, 0], "right": alpha[:, -1], "top": alpha[0]}[side]
        near = cv2.GaussianBlur(edge[:, None], (0, 0), 1.0, sigmaY=_AROUND * len(edge)).ravel() > _TOUCHES
        along = np.clip((x if side == "top" else y).astype(int), 0, len(edge) - 1)
        past = {"left": x < 0.0, "right": x > columns, "top": y < 0.0}[side]
        outside |= past & near[along]
    return outside


def _stem_at_edge(alpha: NDArray[np.float32], placement: Placement, rows: int) -> NDArray[np.float32]:
    """The trunk alone, as the photograph's last row shows it, in its last rows."""
    columns = alpha.shape[1]
    foot = move_places(np.asarray(placement.warp), np.array([placement.camera.foot]))[0]
    last = alpha[-1]
    gaps = np.flatnonzero(last <= _SOLID)
    at = int(np.clip(foot[0], 0, columns - 1))
    solid = np.flatnonzero(last > _SOLID)
    stem = np.zeros_like(alpha)
    if len(solid):
        at = int(solid[np.abs(solid - at).argmin()])
        right = int(np.searchsorted(gaps, at))
        low = int(gaps[right - 1]) if right else 0
        high = int(gaps[right]) + 1 if right < len(gaps) else columns
        stem[-rows:, low:high] = last[low:high]
    return stem
