"""Reads a trimap drawn for a photograph."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from flowtree import check
from flowtree.model.photo import Photo
from flowtree.params import PhotoParams
from flowtree.photos.decode_picture import decode_picture

# How far a lossy file may move black and white.
_NOISE = 5


def read_trimap(path: str | Path, photo: Photo, *, params: PhotoParams = PhotoParams()) -> NDArray[np.uint8]:
    """Reads a grey picture: black is background, white is tree, everything between is unknown.

    The picture may have any size of the photo's aspect (to one percent) and is scaled to the photo; where
    black and white meet inside one pixel of the photo, that pixel is unknown. Colours are read as their
    luminance, an alpha channel is ignored.

    Args:
        path: the file.
        photo: the photo it belongs to.
        params: the cap on pixels.

    Returns:
        (h, w) uint8 of the photo's size: 0 background, 255 tree, 128 unknown.

    Raises:
        InputError: not a picture, another aspect than the photo's, no black or no white in it.
    """
    picture = decode_picture(path, side=None, params=params)
    name = Path(path).name
    require_aspect(name, picture.rgb.shape[:2], photo)
    grey = cv2.cvtColor(picture.rgb, cv2.COLOR_RGB2GRAY)
    height, width = photo.rgb.shape[:2]
    level: NDArray[Any] = np.full(grey.shape, 128, np.float32)
    level[grey <= _NOISE] = 0.0
    level[grey >= 255 - _NOISE] = 255.0
    shrinks = width <= grey.shape[1]
    level = cv2.resize(level, (width, height), interpolation=cv2.INTER_AREA if shrinks else cv2.INTER_NEAREST)
    trimap = np.full(level.shape, 128, np.uint8)
    trimap[level < 0.5] = 0
    trimap[level > 254.5] = 255
    for value, colour, what in ((0, "black", "background"), (255, "white", "tree")):
        found = bool((trimap == value).any())
        check.require(
            found, name, f"needs some {colour} for the {what}", "none", f"paint some {what} {colour}"
        )
    return trimap


def require_aspect(name: str, shape: tuple[int, ...], photo: Photo) -> None:
    """Refuses a picture (h, w) whose aspect differs from the photo's by more than a percent or a pixel.

    Raises:
        InputError: the aspects differ.
    """
    height, width = photo.rgb.shape[:2]
    difference = abs(shape[1] * height - shape[0] * width)
    # A pixel of rounding on either side of either picture is no other aspect.
    slack = max(0.01 * shape[0] * width, height + width, shape[0] + shape[1])
    check.require(
        difference <= slack,
        name,
        f"must have the aspect of {photo.name} ({width} x {height})",
        f"{shape[1]} x {shape[0]}",
        "export it at the size of the upright photo",
    )
