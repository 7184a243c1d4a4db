"""Makes kernels ready while the stages before them run."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager

from flowtree.device import compile_module, pick_device, thread_count
from flowtree.pipeline.import_alone import import_alone
from flowtree.pipeline.stage import Stage


@contextmanager
def load_kernels(stages: Sequence[Stage], device: str | None) -> Iterator[dict[str, Future[None]]]:
    """Compiles the modules of kernels that the stages name, or reads them where they are kept.

    It is begun in the stages' order, in threads of its own: on a new machine a compiler is at work for three
    seconds, outside of Python, while photographs are read and matted. Leaving the block drops what has not
    begun.

    Args:
        stages: that will run; a module that none of them names is left alone.
        device: that they will run on; None picks one.

    Returns: by the module's name, what to wait for before its first launch.
    """
    names = dict.fromkeys(name for stage in stages for name in stage.kernels)
    if not names:
        yield {}
        return
    chosen = pick_device(device)
    pool = ThreadPoolExecutor(min(len(names), thread_count()), thread_name_prefix="flowtree-kernels")
    try:
        yield {name: pool.submit(_load, name, chosen) for name in names}
    finally:
        pool.shutdown(wait=False, cancel_futures=True)


def _load(name: str, device: str) -> None:
    compile_module(import_alone(f"flowtree.kernels.{name}"), device)
