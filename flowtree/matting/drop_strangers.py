"""Takes out of a matte what belongs to a neighbour."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

_SOME = 0.15  # alpha from which on a pixel belongs to a patch
_APART = 0.02  # of the tree's height: half of the gap that parts a patch from the tree
_LARGE = 0.05  # of the largest patch's alpha: what holds more is a part of the tree, however far


def drop_strangers(
    alpha: NDArray[np.float32], claimed: NDArray[np.bool_] | None = None
) -> NDArray[np.float32]:
    """Alpha without small patches that lie far from the tree: fringes of other trees before the sky.

    Args:
        alpha: (h, w) in 0..1.
        claimed: (h, w), what a person says is the tree: patches that hold some of it stay.

    Returns: (h, w).
    """
    seen = alpha > _SOME
    rows = np.flatnonzero(seen.any(axis=1))
    if not len(rows):
        return alpha
    small = min(1.0, 256.0 / float(np.ptp(rows) + 1))
    size = (max(1, round(alpha.shape[1] * small)), max(1, round(alpha.shape[0] * small)))
    shrunk = cv2.resize(np.where(seen, alpha, np.float32(0.0)), size, interpolation=cv2.INTER_AREA)
    reach = max(1, round(_APART * small * float(np.ptp(rows) + 1)))
    brush = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * reach + 1, 2 * reach + 1))
    count, parts = cv2.connectedComponents(cv2.dilate((shrunk > 0.0).astype(np.uint8), brush))
    mass = np.bincount(parts.ravel(), shrunk.ravel(), count)
    strange = mass < _LARGE * mass.max()
    if claimed is not None and claimed.any():
        row, column = np.nonzero(claimed)
        at = (
            np.minimum((row * small).astype(int), size[1] - 1),
            np.minimum((column * small).astype(int), size[0] - 1),
        )
        strange[np.unique(parts[at])] = False
    strange[0] = False
    gone = cv2.resize(strange[parts].astype(np.uint8), alpha.shape[::-1], interpolation=cv2.INTER_NEAREST) > 0
    return np.where(gone, np.float32(0.0), alpha)
