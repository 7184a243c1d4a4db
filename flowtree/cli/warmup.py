"""``flowtree warmup``: everything compiled that is ever compiled."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from flowtree.cli.outputs import check_folder
from flowtree.cli.progress import show_progress

if TYPE_CHECKING:
    from types import ModuleType

_COMPILED = (".o", ".ptx", ".cubin")  # for the CPU, and for CUDA


def warmup() -> None:
    """Compile all kernels now, so that no later command has to.

    What is compiled is kept, and compiled again only after an update.
    """
    with show_progress() as progress:
        progress("start", 0.0)
        from flowtree import device  # starts Warp

        folder = device.kernel_folder()
        check_folder(folder)
        modules = kernel_modules()
        before = _compiled(folder)
        _compile_all(modules, device.pick_device(), progress)
        new = len(_compiled(folder) - before)
        progress("matting", len(modules) / (len(modules) + 1))
        loops, loops_new = _compile_loops()
        progress("done", 1.0)
    typer.echo(f"{folder}: {new} kernel modules compiled, {len(modules) - new} were there")
    typer.echo(f"{loops}: the loops of matting {'compiled' if loops_new else 'were there'}")


def kernel_modules() -> list[ModuleType]:
    """Every module of kernels that there is."""
    import pkgutil
    from importlib import import_module

    from flowtree import kernels

    found = pkgutil.iter_modules(kernels.__path__, f"{kernels.__name__}.")
    return [import_module(module.name) for module in found if not module.ispkg]


def _compile_all(modules: list[ModuleType], device: str, progress: Callable[[str, float], None]) -> None:
    """As many at a time as there are cores: compiling is done outside of Python."""
    from concurrent.futures import ThreadPoolExecutor, as_completed

    from flowtree.device import compile_module, thread_count

    pool = ThreadPoolExecutor(min(thread_count(), len(modules)))
    try:
        jobs = {pool.submit(compile_module, module, device): module.__name__ for module in modules}
        for done, job in enumerate(as_completed(jobs), 1):
            job.result()
            progress(jobs[job].rpartition(".")[2], done / (len(modules) + 1))
    finally:
        pool.shutdown(cancel_futures=True)


def _compile_loops() -> tuple[Path, bool]:
    """Where the loops that matting leaves to Numba are kept, and whether they were compiled just now."""
    from flowtree.errors import OutputError

    try:
        from flowtree.matting.load_laplacian import laplacian_cache

        return laplacian_cache()
    except (OSError, RuntimeError) as error:  # Numba raises the latter where it finds no folder at all
        reason = (
            f"compiled loops cannot be kept: {error}; set NUMBA_CACHE_DIR to a folder that can be written"
        )
        raise OutputError(reason) from error


def _compiled(folder: Path) -> set[Path]:
    return {file for ending in _COMPILED for file in folder.rglob(f"*{ending}")}
