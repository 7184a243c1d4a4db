"""The matting Laplacian of pymatting, without the rest of pymatting."""

from __future__ import annotations

import importlib.util
import sys
from collections.abc import Callable
from pathlib import Path
from threading import Lock
from types import ModuleType
from typing import Any

_NAME = "pymatting.laplacian.cf_laplacian"
_LOADING = Lock()  # two photos may be matted side by side, and the module must be loaded once


def load_laplacian() -> Callable[..., Any]:
    """The function that makes the Laplacian; Numba compiles it, or reads it where it keeps machine code.

    ``import pymatting`` compiles all its Numba functions: 42 s in a new environment (box filters alone 35 s),
    before the first photograph is looked at. The one module that is needed compiles in 2 s.
    """
    function: Callable[..., Any] = _load().cf_laplacian
    return function


def laplacian_cache() -> tuple[Path, bool]:
    """Where Numba keeps the function, and whether this process had to compile it."""
    stats = _load()._cf_laplacian.stats
    return Path(stats.cache_path), not stats.cache_hits


def _load() -> ModuleType:
    with _LOADING:
        if _NAME not in sys.modules:
            package = importlib.util.find_spec("pymatting")
            if package is None or not package.submodule_search_locations:
                raise ModuleNotFoundError("pymatting is not installed")
            file = Path(package.submodule_search_locations[0]) / "laplacian" / "cf_laplacian.py"
            specification = importlib.util.spec_from_file_location(_NAME, file)
            if specification is None or specification.loader is None:
                raise ModuleNotFoundError(f"pymatting has no {file.name}")
            # Numba keeps the machine code under the module's name and looks it up there when it reads it
            # again: it must be the real one, and be there before the functions are made.
            module = sys.modules[_NAME] = importlib.util.module_from_spec(specification)
            try:
                specification.loader.exec_module(module)
            except BaseException:
                del sys.modules[_NAME]
                raise
        return sys.modules[_NAME]
