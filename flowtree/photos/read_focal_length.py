"""The focal length that a picture file says it was taken with."""

from __future__ import annotations

import math
from typing import Any

#: Diagonal of the film that focal lengths are compared on [mm]: 36 x 24.
FILM_DIAGONAL = math.hypot(36.0, 24.0)

_EXIF_FOLDER = 0x8769
_ON_FILM, _FOCAL, _PER_UNIT, _UNIT = 0xA405, 0x920A, 0xA20E, 0xA210
_MILLIMETRES = {2: 25.4, 3: 10.0, 4: 1.0}  # of the unit that pixels of the sensor are counted in
_SHORTEST, _LONGEST = 0.2, 100.0  # picture diagonals; anything else is a mistake in the file


def read_focal_length(exif: Any, width: int, height: int) -> float | None:
    """The focal length [pixels of the file], from its EXIF part.

    Taken is the length as on 36 x 24 mm film, compared by diagonals; else the length itself with the sensor's
    pixels per unit. A picture that was cropped afterwards keeps its pixels but not its diagonal: then the
    first is too short.

    Args:
        exif: mapping of Pillow's kind, with ``get_ifd``.
        width: of the file's picture [pixels].
        height: of the file's picture [pixels].

    Returns: None where the file does not say it, or says nonsense.
    """
    try:
        folder = exif.get_ifd(_EXIF_FOLDER)
    except Exception:  # damaged metadata must not cost the picture
        return None
    diagonal = math.hypot(width, height)
    on_film = _number(folder.get(_ON_FILM))
    length, density = _number(folder.get(_FOCAL)), _number(folder.get(_PER_UNIT))
    if on_film > 0.0:
        pixels = on_film / FILM_DIAGONAL * diagonal
    elif length > 0.0 and density > 0.0:
        unit = _MILLIMETRES.get(int(_number(folder.get(_UNIT, 2))), 25.4)
        pixels = length * density / unit
    else:
        return None
    return pixels if _SHORTEST * diagonal <= pixels <= _LONGEST * diagonal else None


def _number(value: Any) -> float:
    """A finite number, or 0."""
    try:
        number = float(value)
    except (TypeError, ValueError, ZeroDivisionError):
        return 0.0
    return number if math.isfinite(number) else 0.0
