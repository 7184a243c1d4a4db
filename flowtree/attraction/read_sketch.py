"""Reads the sketch of a twig."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from flowtree import check
from flowtree.attraction.read_drawing import read_drawing
from flowtree.geometry.polylines import arc_lengths, drop_repeats


def read_sketch(path: str | Path) -> tuple[NDArray[np.float32], ...]:
    """Reads a drawing that lies on no photo: SVG, JSON or PNG, as `read_drawing` does.

    Args:
        path: the file.

    Returns: polylines (k, 2) float32 as (x, y), y downwards, k >= 2, in the drawing's own units.

    Raises:
        InputError: no such file, another ending, malformed, nothing drawn.
    """
    file = Path(path)
    lines = [drop_repeats(line[:, :2]) for line in read_drawing(file) or []]
    lines = [line for line in lines if len(line) > 1 and arc_lengths(line)[-1] > 0.0]
    check.require(len(lines) > 0, file.name, "needs at least one stroke", "none", "draw a twig")
    return tuple(line.astype(np.float32) for line in lines)
