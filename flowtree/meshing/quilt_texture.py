"""A texture that repeats without a seam, from a sample of any shape (Efros and Freeman 2001)."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

_OVERLAP = 3  # a block's share that lies over its neighbours is one in so many
_GOOD = 1.15  # times the least error: places in the sample that are as good
_FEATHER = 1.0  # pixels

Picture = NDArray[np.float32]


def quilt_texture(sample: Picture, size: int, *, block: int, random: np.random.Generator) -> Picture:
    """Image quilting on a torus: blocks of the sample that agree where they overlap, cut along good seams.

    The paper quilts a rectangle; here a block at the right or lower border overlaps those at the other one,
    so that the result tiles both ways.

    Args:
        sample: (h, w, 3) float32.
        size: of the result; it is rounded to whole steps of blocks first and scaled then.
        block: [pixels], at most the sample's smaller side.
        random: chooses among places in the sample that are as good.

    Returns: (size, size, 3) float32.
    """
    block = max(_OVERLAP, min(block, sample.shape[0], sample.shape[1]))
    lap = max(1, block // _OVERLAP)
    step = block - lap
    count = max(2, round(size / step))
    whole = count * step
    made = np.zeros((whole, whole, 3), np.float32)
    filled = np.zeros((whole, whole), bool)
    weight = sample @ np.array([0.3, 0.5, 0.2], np.float32)
    for row in range(count):
        for column in range(count):
            rows = (row * step + np.arange(block)) % whole
            columns = (column * step + np.arange(block)) % whole
            place = np.ix_(rows, columns)
            there, known = filled[place], made[place]
            found = _choose(sample, weight, known, there, random)
            share = _cut(known, found, there, lap)
            made[place] = known + share[..., None] * (found - known)
            filled[place] = True
    return np.asarray(cv2.resize(made, (size, size), interpolation=cv2.INTER_AREA), np.float32)


def _choose(
    sample: Picture, weight: Picture, known: Picture, there: NDArray[np.bool_], random: np.random.Generator
) -> Picture:
    """A block of the sample that agrees with what is known of it."""
    block = len(known)
    rows, columns = sample.shape[0] - block + 1, sample.shape[1] - block + 1
    if there.any():
        grey = (known @ np.array([0.3, 0.5, 0.2], np.float32)).astype(np.float32)
        error = cv2.matchTemplate(weight, grey, cv2.TM_SQDIFF, mask=there.astype(np.float32))
        error = np.maximum(error, 0.0)
        good = np.flatnonzero(error <= _GOOD * error.min() + 1e-9)
        chosen = int(good[random.integers(len(good))])
    else:
        chosen = int(random.integers(rows * columns))
    row, column = divmod(chosen, columns)
    return sample[row : row + block, column : column + block]


def _cut(known: Picture, found: Picture, there: NDArray[np.bool_], lap: int) -> Picture:
    """How much of the found block is seen, 0..1, (block, block): beyond the cheapest seam on every side."""
    error = ((known - found) ** 2).sum(axis=2)
    seen = np.ones(there.shape, np.float32)
    # Each side in turn is made the left one.
    for turns in range(4):
        mask = np.rot90(seen, turns)
        if np.rot90(there, turns)[:, :lap].mean() > 0.5:
            mask[:, :lap] = np.minimum(mask[:, :lap], _beyond_seam(np.rot90(error, turns)[:, :lap]))
    seen[~there] = 1.0
    return seen


def _beyond_seam(error: NDArray[np.float32]) -> Picture:
    """1 right of the cheapest way down through an error surface (n, m), 0 left of it, soft between."""
    rows, columns = error.shape
    total = error.astype(np.float64).copy()
    for row in range(1, rows):
        before = np.pad(total[row - 1], 1, constant_values=np.inf)
        total[row] += np.minimum(np.minimum(before[:-2], before[1:-1]), before[2:])
    seam = np.empty(rows, np.int64)
    seam[-1] = int(np.argmin(total[-1]))
    for row in range(rows - 2, -1, -1):
        low = max(seam[row + 1] - 1, 0)
        seam[row] = low + int(np.argmin(total[row, low : seam[row + 1] + 2]))
    away = np.arange(columns)[None, :] - seam[:, None]
    return np.clip(0.5 + away / (2.0 * _FEATHER), 0.0, 1.0).astype(np.float32)
