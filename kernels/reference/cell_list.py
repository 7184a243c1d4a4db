"""The float64 twin of `flowtree.kernels.cell_list`."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray


def cell_of(grid: Any, at: NDArray[Any]) -> NDArray[np.int64]:
    """Cell coordinates of (n, 3) points; one outside the box belongs to the nearest cell at its border."""
    place = np.floor((at - np.asarray(grid.corner, np.float64)) / grid.edge)
    return np.clip(place, 0, np.array([grid.nx, grid.ny, grid.nz]) - 1).astype(np.int64)


def assign_cells(
    first: int,
    position: NDArray[Any],
    state: NDArray[Any],
    grid: Any,
    key_out: NDArray[Any],
    index_out: NDArray[Any],
) -> None:
    """Gives every particle its cell as a sort key; those that take no part sort behind the last cell."""
    n = len(state)
    cell = cell_of(grid, np.asarray(position, np.float64))
    key = cell[:, 0] + grid.nx * (cell[:, 1] + grid.ny * cell[:, 2])
    key_out[first:n] = np.where(state == 1, key, grid.nx * grid.ny * grid.nz)[first:]
    index_out[first:n] = np.arange(first, n)


def bound_cells(first: int, key: NDArray[Any], count: int, cells: int, begin_out: NDArray[Any]) -> None:
    """A cell begins at the first sorted key that is not below it; every thread's part is done at once."""
    assert first == 0, "the twin finds all cells at once"
    begin_out[:] = np.searchsorted(key[:count], np.arange(cells + 1), side="left")
