"""Pictures as files."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from flowtree import check
from flowtree.files import write_whole

PICTURE_ENDINGS = (".png", ".jpg", ".jpeg")


def write_picture(pixels: NDArray[np.uint8], path: Path, *, quality: int = 92) -> None:
    """Writes a picture whole or not at all; the path's ending says as what.

    Args:
        pixels: (h, w), (h, w, 3) or (h, w, 4) uint8 sRGB. JPEG knows no alpha: there it lies on white.
        path: a PNG or JPEG file; its folder must exist.
        quality: of a JPEG, 1 to 100.

    Raises:
        InputError: another ending, another kind of array.
        OutputError: the file could not be written.
    """
    shape, ending = pixels.shape, path.suffix.lower()
    check.require(
        ending in PICTURE_ENDINGS,
        str(path),
        f"must end in {', '.join(PICTURE_ENDINGS)}",
        repr(path.suffix),
        "rename the picture",
    )
    fits = pixels.dtype == np.uint8 and pixels.size > 0 and shape[2:] in ((), (3,), (4,)) and len(shape) > 1
    check.require(
        fits, "picture", "must be (h, w), (h, w, 3) or (h, w, 4) uint8", shape, "pass such an array"
    )
    picture = Image.fromarray(np.ascontiguousarray(pixels))
    data = BytesIO()
    if ending == ".png":
        picture.save(data, "PNG", compress_level=4)
    else:
        if picture.mode == "RGBA":
            ground = Image.new("RGBA", picture.size, "white")
            picture = Image.alpha_composite(ground, picture).convert("RGB")
        picture.save(data, "JPEG", quality=quality, optimize=True)
    write_whole(path, data.getvalue())
