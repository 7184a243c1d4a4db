"""Reads the picture of a leaf."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from flowtree import check
from flowtree.errors import InputError

_LARGEST = 2048  # [pixels] a side that is kept; graphics cards refuse more than some thousands
_MEGAPIXELS = 100


def load_leaf(path: str | Path) -> NDArray[np.uint8]:
    """The picture (h, w, 4) uint8 sRGB with alpha, at most 2048 pixels a side.

    Raises:
        InputError: no such file, no picture, no alpha channel, nothing or everything opaque, too large.
    """
    name = Path(path).name or str(path)
    try:
        with Image.open(path) as image:
            pixels = image.width * image.height
            check.require(
                pixels <= _MEGAPIXELS * 1e6,
                name,
                f"must have at most {_MEGAPIXELS} megapixels",
                f"{image.width} x {image.height}",
                "scale it down",
            )
            check.require(
                image.has_transparency_data,
                name,
                "needs an alpha channel that cuts the leaf out",
                f"mode {image.mode}",
                "save it as PNG with transparency",
            )
            rgba = image.convert("RGBA")
    except (OSError, SyntaxError, ValueError, Image.DecompressionBombError) as error:
        if isinstance(error, InputError):
            raise
        check.fail(name, "must be a picture of a leaf", error, "give a PNG with transparency")
    rgba.thumbnail((_LARGEST, _LARGEST), Image.Resampling.BOX)
    picture: NDArray[np.uint8] = np.array(rgba, np.uint8)
    opaque = float(np.mean(picture[:, :, 3] >= 128))
    check.require(
        0.005 <= opaque < 1.0,
        name,
        "must be opaque where the leaf is and nowhere else",
        f"{opaque:.1%} opaque",
        "cut the leaf out and save it as PNG with transparency",
    )
    return picture
