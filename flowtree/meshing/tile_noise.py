"""Random patterns that repeat without a seam: the pixels of a picture are taken to lie on a torus."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

Floats = NDArray[np.float64]


def tile_noise(
    rng: np.random.Generator, size: int, across: float, down: float, *, rough: float = 1.0
) -> Floats:
    """Smooth noise of mean 0 and variance 1, (size, size), that tiles exactly in both directions.

    White noise is filtered on the torus: a sum of whole waves has no edge.

    Args:
        rng: what is drawn from it does not depend on the other arguments but the size.
        size: of the picture [pixels].
        across: how many bumps fit side by side.
        down: how many fit one above the other.
        rough: 0 for smooth bumps only, 1 for details that fade as in fractal noise, 3 for much detail.
    """
    wave = np.fft.rfft2(rng.standard_normal((size, size)))
    fy = np.fft.fftfreq(size, 1.0 / size)[:, None] / down
    fx = np.fft.rfftfreq(size, 1.0 / size)[None, :] / across
    square = fx**2 + fy**2
    band = np.exp(-0.5 * square) + 0.25 * rough / (1.0 + square) ** 1.25
    band[0, 0] = 0.0
    noise = np.fft.irfft2(wave * band, s=(size, size))
    unit: Floats = noise / noise.std()
    return unit


def tile_cells(
    rng: np.random.Generator, x: Floats, y: Floats, across: int, down: int
) -> tuple[Floats, NDArray[np.int64]]:
    """Worley's cells on the torus: how far inside its cell a point is, and which cell that is.

    Args:
        rng: places one seed in each field of an ``across`` by ``down`` board.
        x: any shape, 0..1 across the picture; values beyond wrap around.
        y: the same, downwards.
        across: cells side by side.
        down: cells one above the other.

    Returns: the distance to the second nearest seed minus that to the nearest, in fields, 0 on a border; and
        the nearest seed's number, below ``across * down``.
    """
    column, row = np.meshgrid(np.arange(across), np.arange(down))
    # Every second column is pushed half a field, so that borders do not line up into rows.
    jitter = rng.uniform(0.1, 0.9, (2, down, across))
    seeds = np.stack([column + jitter[0], row + jitter[1] + 0.5 * (column % 2)], axis=-1).reshape(-1, 2)
    box = np.array([across, down], np.float64)
    tree = cKDTree(np.mod(seeds, box), boxsize=box)
    points = np.stack([np.mod(x, 1.0) * across, np.mod(y, 1.0) * down], axis=-1)
    # Modulo may round up to the box itself, which the tree does not take.
    distance, number = tree.query(np.where(points >= box, 0.0, points), k=2)
    return distance[..., 1] - distance[..., 0], number[..., 0]
