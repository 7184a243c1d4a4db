"""Options that belong to single photos."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

from flowtree import check


def per_photo(values: Sequence[str] | None, count: int, option: str) -> dict[int, Path]:
    """Files by the photo's number: the k-th belongs to the k-th photo, or ``1=FILE`` names it (from 0).

    Raises:
        InputError: more files than photos, a photo that is not there, or two files for one photo.
    """
    files: dict[int, Path] = {}
    for k, value in enumerate(values or ()):
        named = re.fullmatch(r"(\d+)=(.+)", value, re.DOTALL)
        photo, file = (int(named[1]), named[2]) if named else (k, value)
        check.require(
            photo < count,
            option,
            f"must belong to a photo, 0 to {count - 1}",
            f"{value!r} for photo {photo}",
            "give at most one a photo",
        )
        check.require(
            photo not in files,
            option,
            "must be given once a photo",
            f"{value!r} as another for photo {photo}",
            "number all of them, such as 0=FILE",
        )
        files[photo] = Path(file)
    return files


def parse_yaws(text: str | None) -> tuple[float, ...] | None:
    """``0,90`` as numbers [degrees].

    Raises:
        InputError: something between the commas is no number.
    """
    if text is None:
        return None
    try:
        return tuple(float(part) for part in text.split(","))
    except ValueError:
        check.fail("--yaw", "must be numbers with commas between", repr(text), "write --yaw 0,90")
