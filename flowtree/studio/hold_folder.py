"""One process holds a project's folder at a time."""

from __future__ import annotations

import os
import sys
from pathlib import Path

from flowtree import check
from flowtree.errors import OutputError

_NAME = ".flowtree-studio.lock"


class HeldFolder:
    """Holds a folder until it is released, or its process ends in whatever way.

    Args:
        folder: of the project; it must exist.

    Raises:
        InputError: another process holds it.
        OutputError: the folder cannot be written.
    """

    def __init__(self, folder: Path) -> None:
        try:
            self._file = (folder / _NAME).open("a+")
        except OSError as error:
            text = f"{folder}: could not be written: {error.strerror}; name another folder"
            raise OutputError(check.one_line(text)) from error
        if not _lock(self._file.fileno()):
            self._file.seek(0)
            other = self._file.read().strip() or "unknown"
            self._file.close()
            check.fail(
                str(folder),
                "must be open in one studio at a time",
                f"a project that process {other} holds",
                "close that one, or open another folder",
            )
        self._file.truncate(0)
        self._file.write(str(os.getpid()))
        self._file.flush()

    def release(self) -> None:
        """Lets others open the folder."""
        self._file.close()


if sys.platform == "win32":
    import msvcrt

    def _lock(descriptor: int) -> bool:
        try:
            os.lseek(descriptor, 1 << 20, os.SEEK_SET)  # beyond the text, which others may read
            msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)
        except OSError:
            return False
        return True

else:
    import fcntl

    def _lock(descriptor: int) -> bool:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            return False
        return True
