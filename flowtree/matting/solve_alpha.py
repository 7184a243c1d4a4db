"""Closed-form matting with soft estimates."""

from __future__ import annotations

import numpy as np
import scipy.sparse
from numpy.typing import NDArray

from flowtree.matting.load_laplacian import load_laplacian

KNOWN = 100.0  # confidence from which a pixel keeps its alpha
_TOLERANCE, _MOST = 1e-4, 300  # of the residual, relative to the right side; steps at most
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
    value[open_] = _descend(system, target, value[open_])
    alpha: NDArray[np.float32] = np.clip(value, 0.0, 1.0).reshape(height, width).astype(np.float32)
    return alpha


def _descend(
    system: scipy.sparse.csr_matrix, target: NDArray[np.float64], start: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Conjugate gradients with a diagonal preconditioner.

    SciPy's own leaves its sums to the BLAS: they depend on the number of cores, and its threads, waiting for
    each other, cost ten times the arithmetic where other work goes on.
    """
    inverse = 1.0 / system.diagonal()
    value = start.copy()
    residual = target - system @ value
    least = _TOLERANCE**2 * float((target * target).sum())
    step = inverse * residual
    energy = float((residual * step).sum())
    for _ in range(_MOST):
        if float((residual * residual).sum()) <= least:
            break
        image = system @ step
        length = energy / float((step * image).sum())
        value += length * step
        residual -= length * image
        better = inverse * residual
        before, energy = energy, float((residual * better).sum())
        step *= energy / before
        step += better
    return value
