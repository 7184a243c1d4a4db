"""Alpha that an alpha test cuts into as much as there was."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float32]
_BLOCK = 8  # pixels


def keep_coverage(alpha: Floats, cutoff: float, share: Floats | None = None) -> Floats:
    """Bends alpha so that of every part of the picture the share above the cut-off is its mean alpha.

    A crown of twigs thinner than a pixel has alpha below the cut-off everywhere: the test would let nothing
    stand. In blocks of 8 x 8 pixels the threshold is found above which as many pixels lie as are covered in
    all (as Castaño 2010 does for whole mip maps), and it is interpolated between the blocks' centres; there
    alpha becomes the cut-off, and 0 and 1 stay what they are.

    Args:
        alpha: (h, w) in 0..1.
        cutoff: of the alpha test, inside 0..1.
        share: (h, w) in 0..1, to be above the cut-off instead of the mean alpha.

    Returns: (h, w) in 0..1.
    """
    rows, columns = alpha.shape
    blocks = _blocks(alpha)
    order = np.sort(blocks, axis=2)[:, :, ::-1]
    size = _BLOCK * _BLOCK
    covered = blocks if share is None else _blocks(share)
    count = np.rint(covered.sum(axis=2, dtype=np.float64)).astype(np.int64)
    # Nothing is covered where nothing is.
    count = np.minimum(count, (blocks > 0).sum(axis=2))
    within = np.take_along_axis(order, np.clip(count - 1, 0, size - 1)[:, :, None], 2)[:, :, 0]
    beyond = np.take_along_axis(order, np.clip(count, 0, size - 1)[:, :, None], 2)[:, :, 0]
    between = 0.5 * (within + beyond)
    # Where nothing is covered, or less than half a pixel, the threshold lies above all that is there.
    threshold = np.where(count == 0, np.maximum(cutoff, 1.01 * order[:, :, 0]), between)
    threshold = np.clip(np.where(count == size, 0.99 * within, threshold), 0.02, 0.98)
    smooth = threshold.astype(np.float32)
    for axis, length in ((0, rows), (1, columns)):
        place = (np.arange(length) + 0.5) / _BLOCK - 0.5
        low = np.clip(np.floor(place).astype(np.int64), 0, smooth.shape[axis] - 1)
        high = np.minimum(low + 1, smooth.shape[axis] - 1)
        share = np.clip(place - low, 0.0, 1.0).astype(np.float32)
        share = share[:, None] if axis == 0 else share[None, :]
        smooth = (1 - share) * np.take(smooth, low, axis) + share * np.take(smooth, high, axis)
    below = cutoff * alpha / smooth
    above = cutoff + (1 - cutoff) * (alpha - smooth) / (1 - smooth)
    return np.asarray(np.clip(np.where(alpha < smooth, below, above), 0.0, 1.0), np.float32)


def _blocks(picture: Floats) -> Floats:
    """The pixels (down, across, 64) of each block; 0 beyond the edge."""
    rows, columns = picture.shape
    padded = np.pad(picture, [(0, -rows % _BLOCK), (0, -columns % _BLOCK)])
    down, across = (side // _BLOCK for side in padded.shape)
    return padded.reshape(down, _BLOCK, across, _BLOCK).transpose(0, 2, 1, 3).reshape(down, across, -1)
