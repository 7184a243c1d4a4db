"""What matting finds out about a photo before anybody scribbles on it."""

from __future__ import annotations

import re
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from flowtree import check
from flowtree.matting.find_sky import Sky, find_sky
from flowtree.matting.trace_trunk import Bands, measure_bands
from flowtree.model.photo import Photo
from flowtree.params import MattingParams

_PICKED = 10.0  # colours this near to a picked one follow it [CIELAB]
_STRENGTH = 5.0  # log-odds of the picked colour itself
_BACKDROP = -3.0  # log-odds below which a colour is what lies behind the tree


@dataclass(frozen=True)
class PreparedPhoto:
    """Everything about one photo that no scribble changes: a second matte of it is made in half the time.

    It depends on the photo and on the parameters, and holds about 100 bytes a pixel of the small picture.

    Attributes:
        photo: the photo itself.
        params: with which it was prepared.
        small: (h, w, 3) uint8, the photo at the size that is solved.
        lab: (h, w, 3) float32, the same as CIELAB.
        texture: (h, w) float32, local deviation of the colours.
        picked: (h, w) float32, log-odds for the tree from the picked colours.
        sky: as it is found without scribbles.
        bands: how much upright bands differ from their sides, for the trunk.
    """

    photo: Photo
    params: MattingParams
    small: NDArray[np.uint8]
    lab: NDArray[np.float32]
    texture: NDArray[np.float32]
    picked: NDArray[np.float32]
    sky: Sky
    bands: Bands


def prepare_photo(photo: Photo, *, params: MattingParams = MattingParams()) -> PreparedPhoto:
    """Looks at a photo once, so that `extract_matte` need not do so again after every scribble.

    Args:
        photo: with h x w pixels.
        params: picked colours, and the size to solve at.

    Raises:
        InputError: a picked colour that is none.
    """
    small = scale_down(photo.rgb, params.solve_height)
    unit = small.astype(np.float32) / np.float32(255.0)
    lab: NDArray[np.float32] = cv2.cvtColor(unit, cv2.COLOR_RGB2Lab).astype(np.float32)
    texture = np.minimum(_deviation(lab, 2), 1.3 * _deviation(lab, 1))
    picked = np.zeros(texture.shape, np.float32)
    for name, colors, sign in (
        ("matting.foreground_colors", params.foreground_colors, 1.0),
        ("matting.background_colors", params.background_colors, -1.0),
    ):
        chosen = _parse(name, colors)
        if len(chosen):
            away = np.min([np.linalg.norm(lab - color, axis=2) for color in chosen], axis=0)
            picked += np.float32(_STRENGTH * sign) * np.exp(-((away / _PICKED) ** 2)).astype(np.float32)
    backdrop = picked < _BACKDROP
    sky = find_sky(lab, texture, backdrop if backdrop.any() else None)
    return PreparedPhoto(photo, params, small, lab, texture, picked, sky, measure_bands(lab))


def scale_down(rgb: NDArray[np.uint8], side: int) -> NDArray[np.uint8]:
    """The picture (h, w, 3), its larger side at most ``side`` pixels."""
    height, width = rgb.shape[:2]
    scale = side / max(height, width)
    if scale >= 1.0:
        return rgb
    size = (max(3, round(width * scale)), max(3, round(height * scale)))
    small: NDArray[np.uint8] = cv2.resize(rgb, size, interpolation=cv2.INTER_AREA).astype(np.uint8)
    return small


def _deviation(lab: NDArray[np.float32], reach: int) -> NDArray[np.float32]:
    """Standard deviation (h, w) of the colours in a square window."""
    window = (2 * reach + 1, 2 * reach + 1)
    mean = cv2.blur(lab, window, borderType=cv2.BORDER_REFLECT)
    square = cv2.blur(lab * lab, window, borderType=cv2.BORDER_REFLECT)
    deviation: NDArray[np.float32] = np.sqrt(np.maximum(square - mean * mean, 0.0).sum(axis=2))
    return deviation


def _parse(name: str, colors: tuple[str, ...]) -> NDArray[np.float32]:
    """Picked colours, #rrggbb, as (n, 3) CIELAB."""
    for color in colors:
        valid = re.fullmatch(r"#[0-9a-fA-F]{6}", color) is not None
        check.require(
            valid, name, "must hold colours as #rrggbb", repr(color)[:40], "write them like #3a5f0b"
        )
    if not colors:
        return np.zeros((0, 3), np.float32)
    values = [[int(color[k : k + 2], 16) / 255.0 for k in (1, 3, 5)] for color in colors]
    lab: NDArray[np.float32] = cv2.cvtColor(np.array([values], np.float32), cv2.COLOR_RGB2Lab)[0]
    return lab
