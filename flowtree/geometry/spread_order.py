"""An order of points in which every beginning of it is spread as evenly as the whole."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from flowtree.geometry.morton import morton_order


def spread_order(points: NDArray[np.floating[Any]], *, seed: int = 0) -> NDArray[np.int64]:
    """The order of points (n, 3) by the reversed bits of their place on a space-filling curve.

    The first m of them stand about n / m places of the curve apart: dense parts keep more points than sparse
    ones, in proportion, and no part loses all of its own before its neighbours have lost theirs.

    Args:
        points: (n, 3).
        seed: others begin elsewhere.
    """
    along = morton_order(points)
    bits = max(1, int(len(points) - 1).bit_length())
    rank = np.arange(len(points))
    turned = np.zeros(len(points), np.int64)
    for bit in range(bits):
        turned |= ((rank >> bit) & 1) << (bits - 1 - bit)
    begin = int(np.random.default_rng(seed).integers(1 << bits))
    return along[np.argsort(turned ^ begin, kind="stable")]
