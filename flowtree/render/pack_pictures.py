"""Pictures of many sizes side by side in one texture."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from flowtree import check

_STEPS = 24  # of halving the range of scales


@dataclass(frozen=True)
class Packing:
    """Where each picture lies; all in pixels.

    Attributes:
        scale: pixels to a unit of length.
        columns: width of each picture.
        rows: height.
        left: first column.
        upper: first row.
        shape: rows and columns of the texture.
    """

    scale: float
    columns: tuple[int, ...]
    rows: tuple[int, ...]
    left: tuple[int, ...]
    upper: tuple[int, ...]
    shape: tuple[int, int]


def pack_pictures(sizes: Sequence[tuple[float, float]], size: int, *, least: int, step: int = 4) -> Packing:
    """Lays pictures out in shelves, the tallest first, as large as a square texture can hold them.

    Args:
        sizes: widths and heights, all in one unit of length, positive.
        size: side of the texture [pixels], of which what stays free at the right and below is cut off.
        least: sides of the smallest picture [pixels].
        step: sides are multiples of it [pixels].

    Raises:
        InputError: the texture is too small for so many pictures.
    """
    smallest = _lay(sizes, 0.0, size, least, step)
    check.require(
        smallest is not None,
        "impostor",
        f"needs room for {len(sizes)} pictures of {least} pixels",
        f"{size} x {size} pixels",
        "choose a larger size or fewer pictures",
    )
    assert smallest is not None
    low, high, best = 0.0, size / max(max(pair) for pair in sizes), smallest
    for _ in range(_STEPS):
        middle = 0.5 * (low + high)
        tried = _lay(sizes, middle, size, least, step)
        if tried is None:
            high = middle
        else:
            low, best = middle, tried
    return best


def _lay(
    sizes: Sequence[tuple[float, float]], scale: float, size: int, least: int, step: int
) -> Packing | None:
    """Everything at one scale; None where it does not fit."""
    columns, rows = (
        tuple(max(least, int(np.ceil(pair[axis] * scale / step)) * step) for pair in sizes) for axis in (0, 1)
    )
    left, upper = [0] * len(sizes), [0] * len(sizes)
    right, wide, top, bottom = 0, 0, 0, 0
    for k in sorted(range(len(sizes)), key=lambda k: (-rows[k], -columns[k], k)):
        if right + columns[k] > size:
            right, top = 0, bottom
        left[k], upper[k] = right, top
        right, bottom = right + columns[k], max(bottom, top + rows[k])
        wide = max(wide, right)
    if wide > size or bottom > size:
        return None
    return Packing(scale, columns, rows, tuple(left), tuple(upper), (bottom, wide))
