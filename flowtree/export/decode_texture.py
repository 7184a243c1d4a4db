"""Pictures from the bytes of a PNG or JPEG file."""

from __future__ import annotations

import io
from typing import NoReturn

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from flowtree import check

# A texture of a tree is far smaller; a header that claims more is damaged or hostile.
_MOST_PIXELS = 2**26


def decode_texture(data: bytes, thing: str) -> NDArray[np.uint8]:
    """Decodes a picture to (h, w, 3) uint8, or (h, w, 4) where it has an alpha channel.

    Raises:
        InputError: the bytes are no PNG or JPEG picture, or one of more than 67 megapixels.
    """
    picture = _open(data, thing)
    try:
        mode = "RGBA" if "A" in picture.getbands() or "transparency" in picture.info else "RGB"
        return np.asarray(picture.convert(mode), np.uint8)
    except (OSError, ValueError, SyntaxError, EOFError) as error:
        _refuse(thing, error)


def texture_size(data: bytes, thing: str) -> tuple[int, int]:
    """Width and height [pixels], from the file's head alone.

    Raises:
        InputError: as `decode_texture`.
    """
    return _open(data, thing).size


def _open(data: bytes, thing: str) -> Image.Image:
    try:
        picture = Image.open(io.BytesIO(data), formats=("PNG", "JPEG"))
    except (OSError, ValueError, SyntaxError, EOFError, Image.DecompressionBombError) as error:
        _refuse(thing, error)
    pixels = picture.width * picture.height
    check.require(
        pixels <= _MOST_PIXELS, thing, "must have at most 67 megapixels", f"{pixels / 1e6:.0f}", "shrink it"
    )
    return picture


def _refuse(thing: str, error: Exception) -> NoReturn:
    check.fail(thing, "must be a PNG or JPEG picture", str(error), "export the file again")
