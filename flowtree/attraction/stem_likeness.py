"""Where the picture has the stem's colour."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from flowtree.attraction.cut_working_grid import WorkingGrid
from flowtree.attraction.outline_crown import CrownOutline

_Map = NDArray[np.float64]


def stem_likeness(grid: WorkingGrid, crown: CrownOutline) -> _Map:
    """How much a cell's colour is the stem's rather than the crown's, 0..1; 0.5 where they look the same."""
    rows = np.arange(grid.alpha.shape[0])[:, None]
    solid = grid.alpha > 0.6
    stem = solid & crown.shape & (rows > crown.base + 0.01 * grid.tall)
    leaves = solid & crown.shape & (rows < crown.base - 0.05 * grid.tall)
    if stem.sum() < 20 or leaves.sum() < 20:
        return np.full(grid.alpha.shape, 0.5)
    near, far = _color_distance(grid.lab, stem), _color_distance(grid.lab, leaves)
    likeness = 1.0 / (1.0 + np.exp(np.clip(near - far, -20.0, 20.0)))
    # One cell's colour is noise: only what its neighbours confirm counts. What is beside the tree does not:
    # else no limb thinner than the blur would have the stem's colour.
    weight = grid.alpha.astype(np.float64) + 1e-3
    sigma = 0.004 * grid.tall
    blurred = ndimage.gaussian_filter(likeness * weight, sigma) / ndimage.gaussian_filter(weight, sigma)
    return np.asarray(blurred, np.float64)


def _color_distance(lab: NDArray[np.float32], sample: NDArray[np.bool_]) -> _Map:
    """Negative log likelihood (h, w) of each colour under a Gaussian around the sample's median colour."""
    colors = lab[sample].astype(np.float64)
    middle = np.median(colors, axis=0)
    spread = 1.48 * np.median(np.abs(colors - middle), axis=0) + 4.0
    return np.asarray(0.5 * (((lab - middle) / spread) ** 2).sum(axis=2) + np.log(spread).sum(), np.float64)
