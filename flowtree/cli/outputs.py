"""Checks where results shall go, before the work starts."""

from __future__ import annotations

import tempfile
from collections.abc import Collection
from pathlib import Path

from flowtree import check
from flowtree.errors import OutputError


def check_output(path: Path | None, endings: Collection[str], option: str) -> None:
    """Refuses a file that could not be written in the end.

    Args:
        path: the file; None passes.
        endings: the kinds that can be written, such as ``.glb``.
        option: its name, for the message.

    Raises:
        InputError: the file's ending names no kind that can be written, or there is a folder of that name.
        OutputError: its folder is not there or cannot be written.
    """
    if path is None:
        return
    known = ", ".join(sorted(endings))
    check.require(
        path.suffix.lower() in endings, option, f"must end in {known}", repr(str(path)), "name such a file"
    )
    check.require(not path.is_dir(), option, "must name a file", f"the folder {path}", "add a file name")
    check_folder(path.parent)


def check_folder(folder: Path) -> None:
    """Refuses a folder that is not there or cannot be written.

    Raises:
        OutputError: it is so.
    """
    try:
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        text = f"{folder}: cannot be written: {error.strerror}; make that folder, or name another"
        raise OutputError(check.one_line(text)) from error


def check_new_folder(folder: Path) -> None:
    """Refuses a folder that could neither be written nor made.

    Raises:
        OutputError: it is so.
    """
    while not folder.exists() and folder != folder.parent:
        folder = folder.parent
    check_folder(folder)


def check_distinct(*outputs: Path | None) -> None:
    """Refuses two results in one file.

    Raises:
        InputError: two of the outputs are the same file.
    """
    given = [path.resolve() for path in outputs if path is not None]
    same = [path for k, path in enumerate(given) if path in given[:k]]
    check.require(not same, "output", "must differ from the others", same[:1], "name another file for one")
