"""Closed-form matting with soft estimates."""

from __future__ import annotations

import importlib.util
import sys
from functools import lru_cache
from pathlib import Path
from threading import Lock
from typing import Any

import numpy as np
import scipy.sparse
import scipy.sparse.linalg
from numpy.typing import NDArray

KNOWN = 100.0  # confidence from which a pixel keeps its alpha
_EPSILON = 1e-6  # regularises the colour lines of closed-form matting

_LOADING = Lock()  # two photos may be matted side by side, and the module must be loaded once


def solve_alpha(
    rgb: NDArray[np.uint8], prior: NDArray[np.float32], confidence: NDArray[np.float32]
) -> NDArray[np.float32]:
    """Closed-form matting (Levin, Lischinski and Weiss 2008) with a soft estimate beside the known pixels.

    Solves (L + C) alpha = C prior with the matting Laplacian L of pymatting and the diagonal C of
    confidences. Unlike the trimap form, every unknown pixel has a weak estimate of its own: that keeps the
    system so well conditioned that conjugate gradients with a diagonal preconditioner need some dozen steps,
    even where most of the crown is unknown, and it keeps the gaps that no known background reaches.

    Args:
        rgb: (h, w, 3).
        prior: (h, w) in 0..1.
        confidence: (h, w) > 0; from 100 on the pixel is known.

    Returns: (h, w) in 0..1.
    """
    known = confidence >= KNOWN
    height, width = prior.shape
    if known.all() or min(height, width) < 3:
        return prior.astype(np.float32)
    with _LOADING:
        closed_form = _cf_laplacian()
    laplacian = closed_form(rgb.astype(np.float64) / 255.0, epsilon=_EPSILON, radius=1, is_known=known)
    open_ = ~known.ravel()
    weight = np.where(known, KNOWN, confidence).ravel().astype(np.float64)
    value = prior.ravel().astype(np.float64)
    rows = laplacian.tocsr()[open_]
    system = rows[:, open_] + scipy.sparse.diags(weight[open_])
    target = weight[open_] * value[open_] - rows[:, ~open_] @ value[~open_]
    inverse = 1.0 / system.diagonal()
    solution, _ = scipy.sparse.linalg.cg(
        system,
        target,
        x0=value[open_],
        rtol=1e-4,
        maxiter=300,
        M=scipy.sparse.linalg.LinearOperator(system.shape, lambda residual: inverse * residual),
    )
    value[open_] = solution
    alpha: NDArray[np.float32] = np.clip(value, 0.0, 1.0).reshape(height, width).astype(np.float32)
    return alpha


@lru_cache(maxsize=1)
def _cf_laplacian() -> Any:
    """The matting Laplacian of pymatting, without the rest of pymatting.

    ``import pymatting`` compiles all its Numba functions: 42 s in a new environment (box filters alone 35 s),
    before the first photograph is looked at. The one module that is needed compiles in 2 s.
    """
    name = "pymatting.laplacian.cf_laplacian"
    if name not in sys.modules:
        package = importlib.util.find_spec("pymatting")
        if package is None or not package.submodule_search_locations:
            raise ModuleNotFoundError("pymatting is not installed")
        file = Path(package.submodule_search_locations[0]) / "laplacian" / "cf_laplacian.py"
        specification = importlib.util.spec_from_file_location(name, file)
        if specification is None or specification.loader is None:
            raise ModuleNotFoundError(f"pymatting has no {file.name}")
        # Numba keeps the machine code under the module's name and looks it up there when it reads it again:
        # it must be the real one, and be there before the functions are made.
        module = sys.modules[name] = importlib.util.module_from_spec(specification)
        try:
            specification.loader.exec_module(module)
        except BaseException:
            del sys.modules[name]
            raise
    return sys.modules[name].cf_laplacian
