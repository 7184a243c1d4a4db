"""Files are written whole or not at all: the one place that replaces a file on disk."""

from __future__ import annotations

import contextlib
import errno
import os
import secrets
import shutil
import stat
from collections.abc import Mapping
from pathlib import Path

from flowtree import check
from flowtree.errors import OutputError

_REMEDIES = {
    errno.ENOENT: "make that folder first, or name another one",
    errno.ENOTDIR: "name a folder, not a file, before the last slash",
    errno.EISDIR: "name a file, not a folder",
    errno.EACCES: "change the permissions, or choose another place",
    errno.EPERM: "change the permissions, or choose another place",
    errno.EROFS: "choose a folder that can be written",
    errno.ENOSPC: "free some space, or choose another disk",
    errno.EDQUOT: "free some space, or choose another disk",
    errno.ENAMETOOLONG: "choose a shorter name",
}


def write_whole(path: Path, data: bytes) -> None:
    """Writes one file so that nobody ever sees a part of it.

    The bytes go to a temporary file in the same folder, reach the disk, and take the name in one step; the
    permissions of a file that stood there are kept and a link stays a link. A device or a pipe has nothing to
    keep and is written straight.

    Args:
        path: where to; its folder must exist.
        data: the whole content.

    Raises:
        OutputError: it could not be written; what stood there is untouched and no temporary file is left.
    """
    write_all_whole({path: data})


def write_all_whole(contents: Mapping[Path, bytes]) -> None:
    """Writes several files that belong together: all of them, or none.

    All are written beside their places before the first takes its name, in the mapping's order: put the file
    that refers to the others last. A failure in between brings back what stood there. (A power cut between
    two of those steps can leave new files beside old ones, each of them whole.)

    Args:
        contents: the whole content of each file; the folders must exist.

    Raises:
        OutputError: one could not be written; what stood there is untouched and no temporary file is left.
    """
    temporary: list[Path] = []
    waiting: list[tuple[Path, Path, Path]] = []
    replaced: list[tuple[Path, Path | None]] = []
    failing = Path()
    try:
        for path, data in contents.items():
            failing = path
            target = Path(os.path.realpath(path))
            if _is_stream(path):
                path.write_bytes(data)
            else:
                waiting.append((path, _write_beside(target, data, temporary), target))
        for path, part, target in waiting:
            failing = path
            # A single file needs no way back: its only step either happens or does not.
            old = _keep(target, temporary) if len(waiting) > 1 and target.exists() else None
            os.replace(part, target)
            replaced.append((target, old))
        replaced.clear()
    except (OSError, ValueError) as error:  # ValueError: a name that no file can have, such as one with a NUL
        raise _output_error(failing, error) from error
    finally:
        for target, old in reversed(replaced):
            with contextlib.suppress(OSError):
                target.unlink() if old is None else os.replace(old, target)
        for leftover in temporary:
            with contextlib.suppress(OSError):
                leftover.unlink()


def _is_stream(path: Path) -> bool:
    """Whether something stands there that is neither a file nor a folder (a device, a pipe)."""
    try:
        mode = path.stat().st_mode
    except OSError:
        return False
    if stat.S_ISDIR(mode):
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
    return not stat.S_ISREG(mode)


def _name_beside(target: Path, temporary: list[Path]) -> Path:
    """A new name in the target's folder, remembered for the clean-up before the file exists."""
    name = target.with_name(f".flowtree-{secrets.token_hex(8)}.part")
    temporary.append(name)
    return name


def _write_beside(target: Path, data: bytes, temporary: list[Path]) -> Path:
    """Writes the content to a temporary file in the target's folder, down to the disk."""
    exists = target.exists()
    if exists and not os.access(target, os.W_OK):  # the folder alone would let us replace a protected file
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))
    part = _name_beside(target, temporary)
    with part.open("xb") as file:  # not `tempfile`: its files are closed to everybody but their owner
        file.write(data)
        file.flush()
        os.fsync(file.fileno())
    if exists:
        part.chmod(stat.S_IMODE(target.stat().st_mode))
    return part


def _keep(target: Path, temporary: list[Path]) -> Path:
    """A second name for the file that is about to be replaced."""
    old = _name_beside(target, temporary)
    try:
        os.link(target, old)
    except OSError:  # a file system without hard links
        shutil.copy2(target, old)
    return old


def _output_error(path: Path, error: OSError | ValueError) -> OutputError:
    number = error.errno if isinstance(error, OSError) else None
    reason = (error.strerror if isinstance(error, OSError) else None) or str(error)
    remedy = _REMEDIES.get(number or 0, "choose another place")
    return OutputError(check.one_line(f"{path}: could not be written: {reason}; {remedy}"))
