"""What the pixels look like where sky does not shine through them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

_FARTHEST = 60.0  # distances from the sky beyond this are all alike
_AROUND, _BLEND = 9, 0.1  # window in which the least mixed pixels are sought [pixels]; how sharply they win
_BORDER = 0.3  # what a border costs at least, before a strong edge
_BINS = (16, 30, 30)  # of L*, a*, b*
_LOW, _HIGH = np.array([0.0, -60.0, -60.0]), np.array([100.0, 60.0, 60.0])
CELLS = int(np.prod(_BINS))  # cells of the histogram of colours


@dataclass(frozen=True)
class Looks:
    """Features of a picture (h, w) and of its half size (r, c).

    Attributes:
        unmixed: (h, w) float32 in 0..1, how little of its neighbours' sky a pixel has in it.
        cells: (h, w) int64, the cell of the colours' histogram, see `CELLS`.
        color: (r, c, 3) float32 CIELAB, of the least mixed pixels.
        texture: (r, c) float32, logarithm of the local deviation of the colours.
        clear: (r, c) float32 in 0..1, share without sky near, where texture means something.
        cost_right: (r, c) float32, of a border between a pixel and its right neighbour: cheap along an edge.
        cost_down: (r, c) float32, the same for the neighbour below.
    """

    unmixed: NDArray[np.float32]
    cells: NDArray[np.int64]
    color: NDArray[np.float32]
    texture: NDArray[np.float32]
    clear: NDArray[np.float32]
    cost_right: NDArray[np.float32]
    cost_down: NDArray[np.float32]


def halve(values: NDArray[Any]) -> NDArray[np.float32]:
    """Area averages at half the size, at least four pixels a side."""
    height, width = values.shape[:2]
    size = (max(4, width // 2), max(4, height // 2))
    return cv2.resize(values.astype(np.float32), size, interpolation=cv2.INTER_AREA).astype(np.float32)


def describe_pixels(
    lab: NDArray[np.float32],
    texture: NDArray[np.float32],
    sky: NDArray[np.bool_],
    distance: NDArray[np.float32],
) -> Looks:
    """Features by which the tree is told from what is behind it.

    Before the sky most pixels of a thin crown are part sky, and so neither their colour nor their texture is
    the tree's: the crown below the horizon would look like another tree. Of every neighbourhood with sky in
    it the pixels furthest from the sky's colour count most, and texture is left out there.

    Args:
        lab: (h, w, 3) CIELAB.
        texture: (h, w) local deviation of the colours.
        sky: (h, w).
        distance: (h, w), from the sky's colours.
    """
    away = np.minimum(distance, np.float32(_FARTHEST))
    window = np.ones((_AROUND, _AROUND), np.uint8)
    most = cv2.dilate(away, window)
    mixed = cv2.dilate(sky.astype(np.uint8), window) > 0
    lone = np.where(mixed, np.exp((away - most) / (_BLEND * most + 1.0)), 1.0) * ~sky + 1e-4
    unmixed: NDArray[np.float32] = lone.astype(np.float32)
    share = halve(unmixed)
    color = halve(lab * unmixed[..., None]) / share[..., None]
    log_texture: NDArray[np.float32] = halve(cv2.blur(np.log1p(texture), (5, 5)))
    near = cv2.dilate(sky.astype(np.uint8), np.ones((7, 7), np.uint8)) > 0
    cell = ((lab - _LOW) / (_HIGH - _LOW) * _BINS).astype(np.int64)
    cells = np.ravel_multi_index(tuple(np.clip(cell, 0, np.array(_BINS) - 1).transpose(2, 0, 1)), _BINS)
    smooth: NDArray[Any] = cv2.GaussianBlur(np.dstack([color, 8.0 * log_texture]), (0, 0), 1.2)
    steps = [np.zeros(share.shape, np.float32), np.zeros(share.shape, np.float32)]
    steps[0][:, :-1] = np.abs(np.diff(smooth, axis=1)).sum(axis=2)
    steps[1][:-1] = np.abs(np.diff(smooth, axis=0)).sum(axis=2)
    solid = halve(~sky) > 0.5
    usual = float(np.median(np.concatenate([step[solid] for step in steps]))) if solid.any() else 1.0
    costs = [(_BORDER + np.exp(-0.7 * step / (usual + 1e-3))).astype(np.float32) for step in steps]
    return Looks(unmixed, cells, color.astype(np.float32), log_texture, 1.0 - halve(near), costs[0], costs[1])


def count_colors(cells: NDArray[np.int64], weight: NDArray[np.float32]) -> NDArray[np.float32]:
    """Histogram (`CELLS`,) of the colours of a region, smoothed, of sum 1."""
    counts: NDArray[Any] = np.bincount(cells.ravel(), weight.ravel(), CELLS).reshape(_BINS)
    counts = counts.astype(np.float32)
    for axis, width in enumerate((1.0, 1.2, 1.2)):
        kernel = cv2.getGaussianKernel(9, width, cv2.CV_32F)
        rows: NDArray[Any] = np.ascontiguousarray(np.moveaxis(counts, axis, 0)).reshape(_BINS[axis], -1)
        rows = cv2.filter2D(rows, -1, kernel, borderType=cv2.BORDER_REPLICATE)
        moved = [_BINS[k] for k in range(3) if k != axis]
        counts = np.moveaxis(rows.reshape(_BINS[axis], *moved), 0, axis)
    return (counts / max(float(counts.sum()), 1e-9)).ravel().astype(np.float32)
