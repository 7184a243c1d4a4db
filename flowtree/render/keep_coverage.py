"""Alpha that an alpha test cuts into as much as is asked for."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from flowtree.render.resample_picture import resample_picture

Floats = NDArray[np.float32]
_BLOCK = 4  # pixels
_FINER = 2  # samples along a pixel's side
_SOFT = 4.0  # [pixels]
_RANGE = (0.004, 0.98)  # of thresholds


def keep_coverage(alpha: Floats, share: Floats, cutoff: float) -> Floats:
    """Scales alpha so that of every part of the picture as much passes the alpha test as is asked for.

    A crown of twigs thinner than a pixel has alpha below the cut-off everywhere: the test would let nothing
    stand. In blocks of 4 x 4 pixels the threshold is found above which, between the pixels' centres as
    engines sample textures, as much lies as is asked for (Castaño 2010 does so for whole mip maps); it is
    interpolated between the blocks' centres, and alpha is scaled to bring it to the cut-off. Half of alpha is
    first blurred, but not beyond the next pixel: of pixels that are covered alike those stay that have more
    around them.

    Args:
        alpha: (h, w) in 0..1.
        share: (h, w) in 0..1, how much is to pass.
        cutoff: of the alpha test, inside 0..1.

    Returns: (h, w) in 0..1.
    """
    rows, columns = alpha.shape
    soft = np.float32(0.5) * (alpha + cv2.GaussianBlur(alpha, (0, 0), _SOFT))
    soft[cv2.dilate(alpha, np.ones((3, 3), np.uint8)) == 0] = 0.0
    finer = cv2.resize(soft, (_FINER * columns, _FINER * rows), interpolation=cv2.INTER_LINEAR)
    order = np.sort(_blocks(np.asarray(finer, np.float32), _FINER * _BLOCK), axis=2)[:, :, ::-1]
    size = order.shape[2]
    count = np.rint(_blocks(share, _BLOCK).mean(axis=2, dtype=np.float64) * size).astype(np.int64)
    within = np.take_along_axis(order, np.clip(count - 1, 0, size - 1)[:, :, None], 2)[:, :, 0]
    beyond = np.take_along_axis(order, np.clip(count, 0, size - 1)[:, :, None], 2)[:, :, 0]
    # Where nothing is asked for the threshold lies above all that is there.
    threshold = np.where(count == 0, np.maximum(cutoff, 1.01 * order[:, :, 0]), 0.5 * (within + beyond))
    threshold = np.clip(np.where(count == size, 0.99 * within, threshold), *_RANGE).astype(np.float32)
    down, across = ((np.arange(length) + 0.5) / _BLOCK - 0.5 for length in (rows, columns))
    smooth = resample_picture(threshold, down, across)
    return np.asarray(np.minimum(soft * (np.float32(cutoff) / smooth), 1.0), np.float32)


def _blocks(picture: Floats, side: int) -> Floats:
    """The pixels (down, across, side * side) of each block; 0 beyond the edge."""
    rows, columns = picture.shape
    padded = np.pad(picture, [(0, -rows % side), (0, -columns % side)])
    down, across = (length // side for length in padded.shape)
    return padded.reshape(down, side, across, side).transpose(0, 2, 1, 3).reshape(down, across, -1)
