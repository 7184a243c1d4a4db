"""Chooses among many small things those that together cover each view as they should."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy.sparse as sparse
from numpy.typing import NDArray

_EMPTY = 1e-6


def match_depths(
    matrices: Sequence[sparse.csr_array],
    targets: Sequence[NDArray[np.float64]],
    weights: NDArray[np.float64],
    *,
    rounds: int = 24,
) -> NDArray[np.float64]:
    """Shares in 0..1 of things such that their depths add up to every view's, nearest to the given weights.

    The multiplicative algebraic reconstruction technique, with a lid at 1: in turn for each view, a thing's
    share is multiplied by the ratio of wanted to present depth in the cells that it covers (their mean,
    weighted by how much it covers), so what is in the way of an empty cell goes and what fills a thin one
    stays. From a uniform start it tends to the solution of maximum entropy. Where views disagree the shares
    end up going to and fro between what one view wants and what the next does: the mean of the last round is
    fair to all of them.

    Args:
        matrices: one a view, (cells, things), the depth that each thing gives each cell.
        targets: one a view, (cells,), the depth wanted there.
        weights: (things,) in 0..1, the shares to start from.
        rounds: over all views, at least 1.

    Returns: (things,) in 0..1.
    """
    shares = weights.copy()
    covers = [np.maximum(np.asarray(m.sum(axis=0)).ravel(), _EMPTY) for m in matrices]
    turned = [m.T for m in matrices]  # sorting their entries by things costs more than it saves
    for _ in range(rounds):
        after = []
        for matrix, back, target, cover in zip(matrices, turned, targets, covers, strict=True):
            present = np.asarray(matrix @ shares).ravel()
            ratio = np.minimum(target / np.maximum(present, _EMPTY), 8.0)
            shares = np.minimum(shares * (np.asarray(back @ ratio).ravel() / cover), 1.0)
            after.append(shares)
    return np.asarray(np.mean(after, axis=0))


def draw_shares(shares: NDArray[np.float64], *, seed: int) -> NDArray[np.bool_]:
    """Keeps each thing with its share as probability, by systematic draws along the given order.

    Neighbours in the order make up for each other: of any run of things as many are kept as their shares add
    up to, give or take one.

    Args:
        shares: (n,) in 0..1, neighbours in space near each other.
        seed: of the one random number.

    Returns: (n,) which are kept.
    """
    start = np.random.default_rng(seed).random()
    total = np.concatenate([[0.0], np.cumsum(shares)]) + start
    return np.diff(np.floor(total)) > 0
