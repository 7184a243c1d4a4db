"""Pictures as files."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path
from typing import Literal

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
    ending = path.suffix.lower()
    check.require(
        ending in PICTURE_ENDINGS,
        str(path),
        f"must end in {', '.join(PICTURE_ENDINGS)}",
        repr(path.suffix),
        "rename the picture",
    )
    write_whole(path, encode_picture(pixels, "PNG" if ending == ".png" else "JPEG", quality=quality))


def encode_picture(
    pixels: NDArray[np.uint8], kind: Literal["PNG", "JPEG"], *, quality: int = 92, effort: int = 4
) -> bytes:
    """The bytes of a picture's file.

    Args:
        pixels: as `write_picture` takes them.
        kind: of file.
        quality: of a JPEG, 1 to 100.
        effort: that packing a PNG takes, 0 to 9.

    Raises:
        InputError: another kind of array.
    """
    shape = pixels.shape
    fits = pixels.dtype == np.uint8 and pixels.size > 0 and shape[2:] in ((), (3,), (4,)) and len(shape) > 1
    check.require(
        fits, "picture", "must be (h, w), (h, w, 3) or (h, w, 4) uint8", shape, "pass such an array"
    )
    picture = Image.fromarray(np.ascontiguousarray(pixels))
    data = BytesIO()
    if kind == "PNG":
        picture.save(data, "PNG", compress_level=effort)
    else:
        if picture.mode == "RGBA":
            ground = Image.new("RGBA", picture.size, "white")
            picture = Image.alpha_composite(ground, picture).convert("RGB")
        picture.save(data, "JPEG", quality=quality, optimize=True)
    return data.getvalue()
