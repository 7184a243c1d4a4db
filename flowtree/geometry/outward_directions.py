"""Which way leads out of a cloud of points."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter, map_coordinates

_CELLS = 24  # along the cloud's longest side
_BLUR = 1.5  # cells
_CLEAR = 0.75  # quantile of the slopes at which one counts as much as the way from the middle
_FEWEST = 64  # points that have a density


def outward_directions(points: NDArray[np.floating[Any]]) -> NDArray[np.float32]:
    """Unit vectors (n, 3) out of a cloud of points (n, 3): away from its middle, and to where it thins out.

    The first alone takes the cloud for one ball; the second follows its clumps. Points in the very middle
    have no direction: zero.
    """
    place = points.astype(np.float64)
    away = place - place.mean(axis=0) if len(place) else place
    spread = float(np.sqrt((away**2).sum(axis=1).mean())) if len(place) else 0.0
    if spread <= 1e-9:
        return np.zeros(place.shape, np.float32)
    away /= spread
    if len(place) >= _FEWEST:
        away = away + _slopes(place)
    length = np.linalg.norm(away, axis=1, keepdims=True)
    unit = np.divide(away, length, out=np.zeros_like(away), where=length > 1e-6)
    return np.asarray(unit, np.float32)


def _slopes(place: NDArray[np.float64]) -> NDArray[np.float64]:
    """How fast the density falls at every point, and where to: (n, 3), of length 1 where it clearly does."""
    low, extent = place.min(axis=0), np.ptp(place, axis=0)
    cell = float(extent.max()) / _CELLS
    at = (place - low) / cell + 2.0 * _BLUR
    shape = tuple(int(n) for n in np.ceil(extent / cell + 4.0 * _BLUR) + 1)
    flat = np.ravel_multi_index(tuple(np.rint(at).astype(np.int64).T), shape)
    count = np.bincount(flat, minlength=int(np.prod(shape))).reshape(shape).astype(np.float64)
    # Its root: or the densest clump alone would have slopes.
    density = np.sqrt(gaussian_filter(count, _BLUR, mode="constant"))
    slope = np.stack([map_coordinates(-part, at.T, order=1) for part in np.gradient(density)], axis=1)
    length = np.linalg.norm(slope, axis=1, keepdims=True)
    return np.asarray(slope / np.maximum(length, max(float(np.quantile(length, _CLEAR)), 1e-12)))
