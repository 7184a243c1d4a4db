"""Closed-form matting with soft estimates."""

from __future__ import annotations

import numpy as np
import scipy.sparse
import scipy.sparse.linalg
from numpy.typing import NDArray

from flowtree.matting.load_laplacian import load_laplacian

KNOWN = 100.0  # confidence from which a pixel keeps its alpha
_EPSILON = 1e-6  # regularises the colour lines of closed-form matting


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
    laplacian = load_laplacian()(rgb.astype(np.float64) / 255.0, epsilon=_EPSILON, radius=1, is_known=known)
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
