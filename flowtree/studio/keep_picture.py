"""Takes a picture from outside into a project's folder, once it is known to be one."""

from __future__ import annotations

import contextlib
import re
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from flowtree import check
from flowtree.errors import OutputError
from flowtree.files import write_whole
from flowtree.params import PhotoParams
from flowtree.photos.decode_picture import decode_picture
from flowtree.photos.picture_size import picture_size
from flowtree.project.write_folder import place_of

LARGEST = 100_000_000  # bytes of a file
_ENDINGS = (".jpg", ".jpeg", ".png", ".webp", ".tif", ".tiff")
_DRAWN = (".svg", ".json")  # of a twig, besides pictures
_STRANGE = re.compile(r"[^\w.()+-]+", re.UNICODE)
_LONGEST_NAME = 60
_DEMO = Path(__file__).parent.parent / "cli" / "demo"
#: The bundled pair, and how tall its tree is [m].
DEMO = (_DEMO / "photo_0.jpg", _DEMO / "photo_1.jpg")
DEMO_HEIGHT = 11.0


@dataclass(frozen=True)
class KeptPicture:
    """A picture in the project's folder.

    Attributes:
        place: in the folder.
        width: of the upright picture [pixels].
        height: of the upright picture [pixels].
    """

    place: str
    width: int
    height: int


def keep_picture(folder: Path, kind: str, name: str, data: bytes, params: PhotoParams) -> KeptPicture:
    """Writes a picture where its content says.

    Args:
        folder: of the project.
        kind: "photos" or "pictures".
        name: that somebody gave; only what is harmless of it is kept.
        data: of the file.
        params: the cap on pixels.

    Raises:
        InputError: too large, another ending, or no whole picture.
        OutputError: it could not be written.
    """
    safe = safe_name(name)
    size = f"{len(data) / 1e6:.0f} MB"
    check.require(len(data) <= LARGEST, safe, f"must be under {LARGEST / 1e6:.0f} MB", size, "scale it down")
    ending = PurePosixPath(safe).suffix.lower()
    endings = _ENDINGS if kind == "photos" else (*_ENDINGS, *_DRAWN)
    check.require(
        ending in endings, safe, f"must end in {', '.join(endings)}", repr(ending), "export it anew"
    )
    place = place_of(kind, safe, data)
    file = folder / place
    new = not file.exists()
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        text = f"{folder}: could not be written: {error.strerror}; free some space, or open another folder"
        raise OutputError(check.one_line(text)) from error
    try:
        if new:
            write_whole(file, data)
        if ending in _DRAWN:  # read, and refused if need be, where it is used
            return KeptPicture(place, 0, 0)
        decode_picture(file, side=params.working_height, params=params)
        return KeptPicture(place, *picture_size(file))
    except BaseException:
        with contextlib.suppress(OSError):
            if new:
                file.unlink(missing_ok=True)
                file.parent.rmdir()
        raise


def safe_name(name: str) -> str:
    """A file's name without folders, control characters and what else may surprise; never empty."""
    last = name.replace("\\", "/").rsplit("/", 1)[-1]
    stem, dot, ending = _STRANGE.sub("_", last).strip(".").rpartition(".")
    return f"{stem[:_LONGEST_NAME]}{dot}{ending[:8]}" if stem else f"picture.{ending[:8] or 'jpg'}"
