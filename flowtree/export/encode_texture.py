"""Pictures as the bytes of a PNG or JPEG file."""

from __future__ import annotations

import io

import numpy as np
from numpy.typing import NDArray
from PIL import Image

# Below this many pixels a side a PNG is as small, and a flat colour stays exact.
_JPEG_FROM = 64
_JPEG_QUALITY = 92


def encode_texture(pixels: NDArray[np.uint8], *, lossy: bool) -> tuple[bytes, str]:
    """Encodes a picture; the same pixels always give the same bytes.

    Args:
        pixels: (h, w, 3) or (h, w, 4) uint8, row 0 on top. Colour under alpha 0 is kept: it is what a
            renderer's smaller mipmaps blend into the edge.
        lossy: whether JPEG may be used; it is, when there is no alpha and the picture is not tiny.

    Returns:
        The file's bytes and its media type, "image/png" or "image/jpeg".
    """
    picture = Image.fromarray(np.ascontiguousarray(pixels))
    buffer = io.BytesIO()
    if lossy and pixels.shape[2] == 3 and min(pixels.shape[:2]) >= _JPEG_FROM:
        picture.save(buffer, "JPEG", quality=_JPEG_QUALITY, subsampling=0)
        return buffer.getvalue(), "image/jpeg"
    picture.save(buffer, "PNG", compress_level=6)
    return buffer.getvalue(), "image/png"
