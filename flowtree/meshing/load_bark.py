"""Reads the picture of a bark."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from flowtree import check
from flowtree.errors import InputError
from flowtree.model.mesh import Material

_LARGEST = 2048  # [pixels] a side that is kept; graphics cards refuse more than some thousands
_SMALLEST = 8
_MEGAPIXELS = 100


def load_bark(path: str | Path) -> Material:
    """A bark material from the user's picture as it is: it should tile, its upper side lies toward the tip.

    Transparency is ignored: wood is solid. There is no normal map.

    Raises:
        InputError: no such file, no picture, smaller than 8 x 8, larger than 100 megapixels.
    """
    name = Path(path).name or str(path)
    try:
        with Image.open(path) as image:
            size = f"{image.width} x {image.height} pixels"
            check.require(
                min(image.size) >= _SMALLEST, name, "must be 8 x 8 pixels or more", size, "use a larger one"
            )
            check.require(
                image.width * image.height <= _MEGAPIXELS * 1e6,
                name,
                f"must have at most {_MEGAPIXELS} megapixels",
                size,
                "scale it down",
            )
            rgb = image.convert("RGB")
    except (OSError, SyntaxError, ValueError, Image.DecompressionBombError) as error:
        if isinstance(error, InputError):
            raise
        check.fail(name, "must be a picture of bark", error, "give a PNG or JPEG")
    rgb.thumbnail((_LARGEST, _LARGEST), Image.Resampling.BOX)
    texture: NDArray[np.uint8] = np.array(rgb, np.uint8)
    return Material(name="bark_picture", base_color=texture)
