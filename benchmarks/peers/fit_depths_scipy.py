"""The fit of densities to depths with SciPy's sparse products, the heights shared among all cores."""

from __future__ import annotations

import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import scipy.sparse as sparse
from numpy.typing import NDArray

_Floats = NDArray[np.float32]


def fit_depths_scipy(
    shares: Sequence[sparse.csr_array], depths: Sequence[_Floats], *, iterations: int, tolerance: float
) -> _Floats:
    """Densities (voxels, rows) by the method of `flowtree.density.fit_depths`, nothing carved.

    Float32, no float64 copy of anything, in place wherever NumPy can be; each core has its own heights.
    """
    along = sparse.vstack(shares).tocsr().astype(np.float32)
    across = along.T.tocsr()
    views = [matrix.T.tocsr().astype(np.float32) for matrix in shares]
    cores = len(os.sched_getaffinity(0))
    parts = np.array_split(np.arange(depths[0].shape[1]), cores)

    def fit(rows: NDArray[np.int64]) -> _Floats:
        some = [np.ascontiguousarray(depth[:, rows], np.float32) for depth in depths]
        return _fit(along, across, views, some, iterations, tolerance)

    with ThreadPoolExecutor(cores) as pool:
        return np.concatenate(list(pool.map(fit, parts)), axis=1)


def _fit(
    along: sparse.csr_array,
    across: sparse.csr_array,
    views: list[sparse.csr_array],
    depths: list[_Floats],
    iterations: int,
    tolerance: float,
) -> _Floats:
    depth = np.concatenate(depths)
    now = views[0] @ depths[0]
    for view, part in zip(views[1:], depths[1:], strict=True):
        now *= view @ part
    held = now.sum(axis=0)
    total = depth.sum(axis=0) / len(views)
    now *= np.divide(total, held, out=np.zeros_like(held), where=held > 0)
    length = np.asarray(along.sum(axis=1), np.float32)[:, None]
    weight = np.where(length > 0, 1.0 / np.maximum(length, 0.1), 0.0).astype(np.float32)
    pace = np.float32(1.0 / len(views))
    last, sum_now = now.copy(), along @ now
    sum_last = sum_now.copy()
    age = np.ones(depth.shape[1], np.float32)
    best = np.full(depth.shape[1], np.inf, np.float32)
    whole = float(np.linalg.norm(depth))
    for _ in range(iterations):
        rest = depth - sum_now
        if float(np.linalg.norm(rest)) <= tolerance * whole:
            break
        square = (weight * rest * rest).sum(axis=0)
        worse, fresh = (square > best) & (age > 0), age == 0
        older = 0.5 + np.sqrt(0.25 + age * age)
        momentum = np.where(worse, -1.0, np.where(fresh, 0.0, (age - 1.0) / older)).astype(np.float32)
        best = np.where(worse, best, np.minimum(best, square))
        age = np.where(worse, 0.0, np.where(fresh, 1.0, older)).astype(np.float32)
        rest -= momentum * (sum_now - sum_last)
        rest *= weight
        more = across @ rest
        more *= pace
        more += now
        np.subtract(now, last, out=last)
        last *= momentum
        more += last
        np.maximum(more, 0.0, out=more)
        now, last, sum_last = more, now, sum_now
        sum_now = along @ now
    return now
