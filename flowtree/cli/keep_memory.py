"""Memory that was freed is kept for what comes next."""

from __future__ import annotations

import ctypes

# Numbers of glibc's <malloc.h>.
_TRIM_THRESHOLD, _TOP_PAD, _MMAP_THRESHOLD, _ARENA_MAX = -1, -2, -3, -8
_LARGE = 1 << 30  # [bytes] what is smaller comes from the heap
_PAD = 1 << 26  # [bytes] by which the heap grows


def keep_memory() -> None:
    """Tells glibc to take large arrays from one heap and to keep what is freed.

    By default each array of some megabytes is fetched from the system, which empties it page by page, and
    returned at once: a tenth of the time of a short command. Other C libraries are left as they are.
    """
    try:
        mallopt = ctypes.CDLL(None).mallopt
    except (AttributeError, OSError):
        return
    for option, value in (
        (_MMAP_THRESHOLD, _LARGE),
        (_TRIM_THRESHOLD, _LARGE),
        (_TOP_PAD, _PAD),
        (_ARENA_MAX, 1),
    ):
        mallopt(option, value)
