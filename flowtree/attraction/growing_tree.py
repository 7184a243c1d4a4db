"""A rooted tree on the working grid while paths and strokes are still joining it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from flowtree.attraction.cut_working_grid import WorkingGrid
from flowtree.geometry.polylines import subdivide_polyline

_Array = NDArray[np.float64]


class GrowingTree:
    """Nodes in cells (x, y), each with the node it leads to; parents come before their children.

    Attributes:
        node_at: (h, w) int32, the first node that came to lie in a cell, -1 where there is none.
        parent: of each node; the root's is -1.
        points: of each node.
        drawn: whether a node was drawn by hand and must stay where it is.
    """

    def __init__(self, grid: WorkingGrid, root: _Array) -> None:
        self._grid = grid
        self.node_at = np.full(grid.alpha.shape, -1, np.int32)
        self.parent: list[int] = []
        self.points: list[_Array] = []
        self.drawn: list[bool] = []
        self.add(-1, root, drawn=True)

    def cell_of(self, point: _Array) -> tuple[int, int]:
        """(row, column) of the cell that holds a point, the nearest cell for a point outside."""
        row, column = self._grid.cell_at(point[None, :])[0]
        return int(row), int(column)

    def add(self, parent: int, point: _Array, *, drawn: bool) -> int:
        """Appends a node and returns its number."""
        node = len(self.parent)
        self.parent.append(parent)
        self.points.append(point)
        self.drawn.append(drawn)
        self._mark(point, node)
        return node

    def add_line(self, node: int, line: _Array) -> int:
        """Appends the points (k, 2) of a drawn line to ``node``, one by one; returns the last node."""
        for point in line:
            before = self.points[node]
            node = self.add(node, point, drawn=True)
            inside = np.clip(np.stack([before, point]), 0.0, np.array(self.node_at.shape)[::-1])
            for between in subdivide_polyline(inside, 0.7)[1:-1]:
                self._mark(between, node)
        return node

    def add_path(self, cells: Sequence[tuple[int, int]]) -> int:
        """Appends a livewire path, given from the target to its seed, from where it last touches the tree.

        Returns: the node in the last cell.
        """
        start = next((k for k in range(len(cells) - 1, -1, -1) if self.node_at[cells[k]] >= 0), -1)
        node = int(self.node_at[cells[start]]) if start >= 0 else 0
        for row, column in cells[start + 1 :]:
            node = self.add(node, np.array([column + 0.5, row + 0.5]), drawn=False)
        return node

    def _mark(self, point: _Array, node: int) -> None:
        cell = self.cell_of(point)
        if self.node_at[cell] < 0:
            self.node_at[cell] = node
