"""Kernels can be imported in several threads at once."""

from __future__ import annotations

import subprocess
import sys

# The collector lets other threads go on while one parses, as it may at any time.
_MANY = """
import gc, pkgutil, time
from concurrent.futures import ThreadPoolExecutor
import flowtree.kernels, warp
from flowtree.pipeline.import_alone import import_alone

names = [f"flowtree.kernels.{module.name}" for module in pkgutil.iter_modules(flowtree.kernels.__path__)]
gc.callbacks.append(lambda *_: time.sleep(0.0002))
gc.set_threshold(200)
with ThreadPoolExecutor(8) as pool:
    assert [module.__name__ for module in pool.map(import_alone, names)] == names
"""


def test_kernels_are_imported_in_several_threads():
    done = subprocess.run([sys.executable, "-c", _MANY], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
