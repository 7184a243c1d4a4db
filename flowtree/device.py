"""Picks the device, uploads, and launches kernels on all cores; the only caller of ``wp.launch``."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from copy import copy
from functools import lru_cache
from itertools import pairwise
from pathlib import Path
from threading import Lock, current_thread, main_thread
from types import FrameType, ModuleType
from typing import Any, TypeVar

import numpy as np
import warp as wp
from numpy.typing import NDArray

from flowtree import check
from flowtree.errors import OutputError

_T = TypeVar("_T")


def _start_warp() -> None:
    """Starts Warp without a word: its greeting and, where there is no GPU, its warning are no output of ours.

    The warning is printed by Warp's own library, past Python: only the file descriptor can be turned away.

    Raises:
        OutputError: Warp, which makes the folder for compiled kernels when it starts, cannot.
    """
    wp.config.log_level = wp.LOG_ERROR
    try:
        _start_quietly()
    except OSError as error:
        reason = f"{error.filename}: compiled kernels cannot be kept there: {error.strerror}"
        raise OutputError(f"{reason}; set WARP_CACHE_PATH to a folder that can be written") from error


def _start_quietly() -> None:
    init: Any = wp.init  # Warp leaves it untyped
    try:
        kept = os.dup(2)
    except OSError:  # no standard error at all
        init()
        return
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, 2)
        init()
    finally:
        os.dup2(kept, 2)
        os.close(kept)
        os.close(nowhere)


_start_warp()
# Below this many indices a second core costs more than it saves: a launch alone costs about 9 microseconds.
_SPLIT_FROM = 4096
# Threads of one launch that may wait for each other: beyond this many they share out too little.
_MOST_TOGETHER = 64
_TOGETHER = Lock()


def pick_device(name: str | None = None) -> str:
    """The device to run on: the given one, else CUDA where there is one, else the CPU.

    Raises:
        InputError: this machine has no such device.
    """
    if name is None:
        return "cuda:0" if wp.is_cuda_available() else "cpu"
    known = [str(device) for device in wp.get_devices()]
    wanted = "cuda:0" if name == "cuda" else name
    check.require(
        wanted in known, "device", f"must be one of {', '.join(known)}", repr(name), "name one of them"
    )
    return wanted


def thread_count(threads: int | None = None) -> int:
    """Cores to launch on: as given, else ``FLOWTREE_THREADS``, else all that this process may use.

    Raises:
        InputError: either is not a positive whole number.
    """
    if threads is not None:
        check.require(threads > 0, "threads", "must be at least 1", threads, "give more, or leave it out")
        return threads
    text = os.environ.get("FLOWTREE_THREADS", "")
    if not text:
        return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    valid = text.isdecimal() and int(text) > 0
    check.require(valid, "FLOWTREE_THREADS", "must be a positive whole number", repr(text), "set or unset it")
    return int(text)


def upload(values: NDArray[Any], dtype: Any, device: str) -> Any:
    """A device array with the values; ``dtype`` is a Warp type (``wp.vec3`` for rows of three)."""
    return wp.array(np.ascontiguousarray(values), dtype=dtype, device=device)


def hand_over(values: NDArray[Any], dtype: Any, device: str) -> Any:
    """The same of values that nobody else changes: on the CPU the array lies over their memory."""
    return wp.array(values, dtype=dtype, device=device, copy=False)


def empty(shape: int | tuple[int, ...], dtype: Any, device: str) -> Any:
    """An uninitialised device array."""
    return wp.empty(shape, dtype=dtype, device=device)


def zeros(shape: int | tuple[int, ...], dtype: Any, device: str) -> Any:
    """A device array of zeros."""
    return wp.zeros(shape, dtype=dtype, device=device)


def sort_pairs(keys: Any, values: Any, count: int) -> None:
    """Sorts the first ``count`` int32 keys in place and their values with them, keeping equal keys in order.

    Both arrays hold ``2 * count``: the second half is the sort's working space.
    """
    wp.utils.radix_sort_pairs(keys, values, count)


def launch(
    kernel: Any,
    count: int,
    inputs: Sequence[Any],
    outputs: Sequence[Any],
    *,
    device: str,
    split_from: int = _SPLIT_FROM,
    threads: int | None = None,
) -> None:
    """Runs a one-dimensional kernel over ``count`` indices, on all cores when the device is the CPU.

    The kernel's first argument is its first index (``i = first + wp.tid()``): that is how a range is split.
    Each index is computed exactly as it would be alone, so the number of cores does not change a byte.
    Fewer indices than ``split_from`` stay on one core: less where each index is much work. ``threads`` are
    the cores at most; `thread_count` says how many otherwise.
    """
    if count <= 0:
        return
    threads = 1 if device != "cpu" or count < split_from else min(thread_count(threads), count)
    arguments = [*inputs, *outputs]
    if threads == 1:
        wp.launch(kernel, dim=count, inputs=[0, *arguments], device=device)
        return
    # The first launch of a module compiles it: that must not happen in two threads at once.
    wp.load_module(kernel.module, device=device)
    bounds = [count * k // threads for k in range(threads + 1)]
    pool = _pool(threads - 1)
    jobs = [
        pool.submit(wp.launch, kernel, dim=b - a, inputs=[a, *arguments], device=device)
        for a, b in pairwise(bounds[:-1])
    ]
    wp.launch(kernel, dim=count - bounds[-2], inputs=[bounds[-2], *arguments], device=device)
    for job in jobs:
        job.result()


def launch_together(
    kernel: Any, inputs: Sequence[Any], outputs: Sequence[Any], *, threads: int | None = None
) -> None:
    """Runs a kernel on the CPU with one index a core, all at once: they may wait for each other.

    After its first index the kernel takes the number of them. One such launch runs at a time: two that share
    their threads would wait for each other for ever.
    """
    count = min(thread_count(threads), _MOST_TOGETHER)
    # Packing the arguments takes as long as a thousand steps of a particle: once for all threads.
    first: Any = wp.launch(
        kernel, dim=1, inputs=[0, count, *inputs], outputs=outputs, device="cpu", record_cmd=True
    )
    if count == 1:
        first.launch()
        return
    # This thread is one of them: of two that are woken, both might begin on one core.
    with _TOGETHER, _uninterrupted():
        jobs = [_team(count - 1).submit(_as_rank(first, rank).launch) for rank in range(1, count)]
        first.launch()
        for job in jobs:
            job.result()


def side_by_side(work: Callable[..., _T], *each: Iterable[Any]) -> list[_T]:
    """What ``map`` gives, computed on as many threads as there are cores: for work that leaves Python's lock.

    Raises: what the first of the calls that failed raised.
    """
    calls = list(zip(*each, strict=True))
    threads = min(thread_count(), len(calls))
    if threads < 2:
        return [work(*call) for call in calls]
    with ThreadPoolExecutor(threads, thread_name_prefix="flowtree-side") as pool:
        return [job.result() for job in [pool.submit(work, *call) for call in calls]]


def _as_rank(launch: Any, rank: int) -> Any:
    """The same launch with another first argument."""
    other = copy(launch)
    other.params = list(launch.params)
    other.set_param_at_index(0, rank)
    return other


@contextmanager
def _uninterrupted() -> Iterator[None]:
    """Puts Ctrl-C off: those that have begun would wait for ever for one that never does."""
    if current_thread() is not main_thread():  # only that one is ever interrupted
        yield
        return
    came: list[tuple[int, FrameType | None]] = []
    usual = signal.signal(signal.SIGINT, lambda number, frame: came.append((number, frame)))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, usual)
        if came and callable(usual):
            usual(*came[0])


@lru_cache(maxsize=4)
def _team(threads: int) -> ThreadPoolExecutor:
    return ThreadPoolExecutor(threads, thread_name_prefix="flowtree-team")


@lru_cache(maxsize=4)
def _pool(threads: int) -> ThreadPoolExecutor:
    return ThreadPoolExecutor(threads, thread_name_prefix="flowtree")


def compile_module(module: ModuleType, device: str) -> None:
    """Makes a module of kernels ready to launch: compiled, or read from `kernel_folder`.

    Several modules may be made ready in several threads at once; one module only in one.
    """
    wp.load_module(module, device=device)


def kernel_folder() -> Path:
    """Where compiled kernels are kept: ``WARP_CACHE_PATH``, else the user's own cache folder."""
    return Path(str(wp.config.kernel_cache_dir))
