"""A project that comes as an archive from anywhere."""

from __future__ import annotations

import io
import stat
import tempfile
import zipfile
from dataclasses import replace
from pathlib import Path, PurePosixPath

from flowtree import check
from flowtree.project.document_state import DocumentState
from flowtree.project.load_document import load_document
from flowtree.project.project import PER_PHOTO
from flowtree.project.write_folder import place_of
from flowtree.studio.keep_picture import keep_picture

_MOST_FILES = 500
_MOST_BYTES = 400_000_000  # unpacked
_FOLDERS = ("photos", "pictures", *PER_PHOTO)


def read_archive(data: bytes, folder: Path) -> DocumentState:
    """The state of an archived project, whose photos and pictures lie in a folder afterwards.

    Every name and size is looked at before anything is unpacked, and only what a project holds is: into a
    folder of its own at first, from which photos come over as if they were uploaded.

    Args:
        data: a zip file, such as the studio's export of a project.
        folder: of the project that takes the photos.

    Raises:
        InputError: no zip file, one with strange names, too much in it, or without a project.
        OutputError: the folder cannot be written.
    """
    try:
        archive = zipfile.ZipFile(io.BytesIO(data))
    except (zipfile.BadZipFile, ValueError, OSError) as error:
        check.fail(
            "archive", "must be a zip file of a project", f"something else ({error})", "export it again"
        )
    with archive, tempfile.TemporaryDirectory(prefix="flowtree-archive-") as scratch:
        wanted = _checked(archive)
        base = Path(scratch)
        for entry, place in wanted:
            file = base / place
            file.parent.mkdir(parents=True, exist_ok=True)
            try:
                with archive.open(entry) as packed:
                    content = packed.read(entry.file_size + 1)
            except (zipfile.BadZipFile, RuntimeError, EOFError, OSError, NotImplementedError) as error:
                check.fail("archive", "must be whole and without a password", str(error), "export it again")
            honest = len(content) == entry.file_size
            check.require(honest, "archive", "must say how large its files are", place, "export it again")
            file.write_bytes(content)
        document, _ = load_document(base)
        return _move(document.state, base, folder)


def _checked(archive: zipfile.ZipFile) -> list[tuple[zipfile.ZipInfo, str]]:
    """The entries that a project holds, once all of them are known to be harmless."""
    entries = [entry for entry in archive.infolist() if not entry.is_dir()]
    many = len(entries) <= _MOST_FILES
    check.require(many, "archive", f"must hold at most {_MOST_FILES} files", len(entries), "export it again")
    size = sum(entry.file_size for entry in entries)
    check.require(
        size <= _MOST_BYTES, "archive", "must unpack to under 400 MB", f"{size / 1e6:.0f} MB", "use less"
    )
    wanted = []
    for entry in entries:
        path = PurePosixPath(entry.filename)
        plain = not path.is_absolute() and ".." not in path.parts and "\\" not in entry.filename
        plain = plain and ":" not in entry.filename and not stat.S_ISLNK(entry.external_attr >> 16)
        check.require(
            plain, "archive", "must hold plain files in folders", repr(entry.filename)[:60], "export it again"
        )
        small = entry.filename in ("project.json", "params.toml")
        if small or (len(path.parts) == 3 and path.parts[0] in _FOLDERS):
            wanted.append((entry, path.as_posix()))
    found = any(place == "project.json" for _, place in wanted)
    check.require(found, "archive", "must hold a project.json", "none", "export a project from the studio")
    return wanted


def _move(state: DocumentState, base: Path, folder: Path) -> DocumentState:
    """The state with its files in the other folder."""
    params = state.params.photos
    photos = []
    for photo in state.photos:
        kept = keep_picture(folder, "photos", photo.name, (base / photo.place).read_bytes(), params)
        attached = tuple((kind, _copy(base / place, kind, folder)) for kind, place in photo.attached)
        photos.append(replace(photo, place=kept.place, attached=attached))
    pictures = tuple((name, _copy(base / place, "pictures", folder)) for name, place in state.pictures)
    return replace(state, photos=tuple(photos), pictures=pictures)


def _copy(file: Path, kind: str, folder: Path) -> str:
    data = file.read_bytes()
    place = place_of(kind, file.name, data)
    target = folder / place
    target.parent.mkdir(parents=True, exist_ok=True)
    target.write_bytes(data)
    return place
