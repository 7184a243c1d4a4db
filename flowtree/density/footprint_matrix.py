"""The projection of a slice of voxels onto one row of a view."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sparse
from numpy.typing import NDArray

from flowtree.geometry.projection import view_axes


def footprint_matrix(
    x: NDArray[np.float64], z: NDArray[np.float64], yaw: float, *, left: float, cell: float, columns: int
) -> sparse.csr_array:
    """Mean path length [m] of a row of view cells through every voxel of a horizontal slice.

    With level orthographic cameras every height slice is its own two-dimensional problem with this one
    matrix.
    A square voxel of edge ``cell`` seen from yaw t casts a trapezoid: the convolution of two boxes of widths
    ``cell |cos t|`` and ``cell |sin t|``; its integral over each view cell is exact.

    Args:
        x: (nx,) centres of the voxels [m].
        z: (nz,) centres of the voxels [m].
        yaw: of the view [degrees].
        left: [m], image-right coordinate of the first view cell's border.
        cell: edge of a voxel and width of a view cell [m].
        columns: view cells.

    Returns: (columns, nx * nz), voxels in C order of (x, z); a column of the matrix sums to ``cell``
        wherever the whole footprint lies inside the view cells.
    """
    right, _, _ = view_axes(yaw)
    centre = (x[:, None] * right[0] + z[None, :] * right[2]).ravel()
    wide, narrow = sorted((abs(right[0]) * cell, abs(right[2]) * cell), reverse=True)
    half = (wide + narrow) / 2
    first = np.floor((centre - half - left) / cell).astype(int)
    rows, voxels, weights = [], [], []
    for k in range(3):  # a footprint is at most sqrt(2) cells wide, so it touches at most three
        border = left + (first + k) * cell - centre
        share = _trapezoid_below(border + cell, wide, narrow) - _trapezoid_below(border, wide, narrow)
        inside = (share > 1e-12) & (first + k >= 0) & (first + k < columns)
        rows.append((first + k)[inside])
        voxels.append(np.flatnonzero(inside))
        weights.append(share[inside] * cell)
    triple = (np.concatenate(weights), (np.concatenate(rows), np.concatenate(voxels)))
    return sparse.csr_array(triple, shape=(columns, len(centre)))


def _trapezoid_below(u: NDArray[np.float64], wide: float, narrow: float) -> NDArray[np.float64]:
    """Share of the footprint's area left of ``u``, measured from its centre."""
    if narrow < 1e-9 * wide:
        return np.clip(u / wide + 0.5, 0.0, 1.0)

    def ramp(t: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.maximum(t, 0.0) ** 2 / 2

    a, b = (wide + narrow) / 2, (wide - narrow) / 2
    return np.asarray(
        np.clip((ramp(u + a) - ramp(u + b) - ramp(u - b) + ramp(u - a)) / (wide * narrow), 0, 1)
    )
