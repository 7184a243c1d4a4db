"""How large a picture file is, from its header alone."""

from __future__ import annotations

from pathlib import Path

from PIL import Image

from flowtree import check
from flowtree.photos.lift_pillow_cap import lift_pillow_cap

_ORIENTATION = 0x0112
_TURNED = (5, 6, 7, 8)  # orientations of EXIF that swap width and height


def picture_size(path: str | Path) -> tuple[int, int]:
    """Width and height [pixels] of a picture once it stands upright; no pixel is decoded.

    Raises:
        InputError: no such file, or not a picture.
    """
    file = Path(path)
    try:
        with lift_pillow_cap(), Image.open(file) as opened:
            width, height = opened.size
            turned = opened.getexif().get(_ORIENTATION, 1) in _TURNED
    except Exception as error:  # a plugin raises whatever it stumbles over
        check.fail(file.name, "must be a picture", f"something else ({error})", "export it again")
    return (height, width) if turned else (width, height)
