"""Things that together show what views want, by sparse products: the peer of `choose_cover`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import scipy.sparse as sparse
from numpy.typing import NDArray

from flowtree.geometry.cover_canvas import FINE, CoverCanvas


def choose_cover_scipy(
    canvases: Sequence[CoverCanvas],
    covers: Sequence[sparse.csr_array],
    *,
    batch: NDArray[np.integer],
    chance: NDArray[np.float64],
    sweeps: int = 4,
) -> NDArray[np.bool_]:
    """Which things stay (n,): all of a batch at once, by products with the matrices of what they cover.

    Args:
        canvases: one a view.
        covers: one a view, (n, pixels + 1) shares of pixels.
        batch: (n,) from 0.
        chance: (n,) in 0..1.
        sweeps: over all batches.
    """
    loop = _Loop(canvases, covers, batch, 1)
    chosen, luck = np.full(loop.count, -1), chance[loop.order]
    worth = np.zeros(loop.count, np.float32)
    for _ in range(sweeps):
        for part in loop.parts:
            loop.take(part, chosen[part])
            gain, seen = loop.gains(part)
            worth[part] = gain[:, 0]
            better = worth[part] > 0.0
            share = loop.room(part, np.where(better, 0, -1), seen)
            chosen[part] = np.where(better & (luck[part] < share), 0, -1)
            loop.put(chosen[part], part)
    kept = np.zeros(loop.count, np.bool_)
    kept[loop.order] = (chosen == 0) & (worth > 0.0)
    return kept


class _Loop:
    """What is rendered, and what a batch of things would change; things are kept in the batches' order.

    Attributes:
        count: of the things.
        order: (n,) their old numbers.
        parts: the batches.
    """

    def __init__(
        self,
        canvases: Sequence[CoverCanvas],
        covers: Sequence[sparse.csr_array],
        batch: NDArray[np.integer],
        poses: int,
    ) -> None:
        self.count, self._poses, self._canvases = len(batch), poses, canvases
        self.order = np.argsort(batch, kind="stable")
        last = np.cumsum(np.bincount(batch, minlength=1))
        self.parts = [slice(int(a), int(b)) for a, b in zip([0, *last[:-1]], last, strict=True) if b > a]
        rows = (self.order[:, None] * poses + np.arange(poses)).ravel()
        self._views = [_View(canvas, cover[rows]) for canvas, cover in zip(canvases, covers, strict=True)]

    def put(self, chosen: NDArray[np.int64], part: slice | None = None) -> None:
        """Stands the chosen things of a batch (of all, without one) onto the canvases."""
        self._change(chosen, part, 1.0)

    def take(self, part: slice, chosen: NDArray[np.int64]) -> None:
        """Takes a batch's chosen things away."""
        self._change(chosen, part, -1.0)

    def _change(self, chosen: NDArray[np.int64], part: slice | None, sign: float) -> None:
        present = self._present(chosen) * np.float32(sign)
        for view in self._views:
            view.depth += view.cut(self._rows(part)).deepen @ present

    def gains(self, part: slice) -> tuple[NDArray[np.float32], list[_Seen]]:
        """By how much each pose (n, poses) of a batch would lower the squared error; and what is seen."""
        rows = self._rows(part)
        gain = np.zeros(rows.stop - rows.start, np.float32)
        seen = []
        for view in self._views:
            clear = view.clear()
            wrong = view.error(clear)
            shown, useful = (view.cut(rows).cover @ _pair(clear, view.canvas.spread(wrong))).T
            gain += 2 * useful - view.focus[rows] * shown**2 / np.float32(FINE**2)
            seen.append(_Seen(clear, wrong, shown))
        return gain.reshape(-1, self._poses), seen

    def room(self, part: slice, chosen: NDArray[np.int64], seen: list[_Seen]) -> NDArray[np.float32]:
        """The share of a batch's wishes that the cells have room for where each thing stands: (n,)."""
        rows = self._rows(part)
        present = self._present(chosen)
        total = np.zeros(len(chosen), np.float32)
        for view, now in zip(self._views, seen, strict=True):
            cut = view.cut(rows)
            wished = view.canvas.cell_means(np.asarray(cut.stand @ present, np.float32) * now.clear)
            share = np.asarray(np.clip(now.wrong / np.maximum(wished, 1e-9), 0.0, 1.0), np.float32)
            fits = cut.cover @ (now.clear * view.canvas.spread(share))
            total += np.divide(fits, now.shown, out=np.zeros_like(total), where=now.shown > 0)
        return np.asarray(total / len(self._views), np.float32)

    def _rows(self, part: slice | None) -> slice:
        part = slice(0, self.count) if part is None else part
        return slice(part.start * self._poses, part.stop * self._poses)

    def _present(self, chosen: NDArray[np.int64]) -> NDArray[np.float32]:
        present = np.zeros((len(chosen), self._poses), np.float32)
        there = np.flatnonzero(chosen >= 0)
        present[there, chosen[there]] = 1.0
        return present.ravel()


class _View:
    """One view of the loop.

    Attributes:
        canvas: with what stands there anyway.
        cover: (rows, pixels + 1).
        depths: the same as optical depths.
        focus: (rows,) sum of squares of a row's shares of the cells: 1 where all of it lies in one cell.
        depth: (pixels + 1,) float32 of all that is rendered.
    """

    def __init__(self, canvas: CoverCanvas, cover: sparse.csr_array) -> None:
        self.canvas, self.cover = canvas, cover
        self.depths = sparse.csr_array((-np.log1p(-cover.data), cover.indices, cover.indptr), cover.shape)
        cells = sparse.csr_array(
            (cover.data.copy(), canvas.cell_index(cover.indices), cover.indptr.copy()),
            shape=(cover.shape[0], canvas.grid.columns * canvas.grid.rows + 1),
        )
        cells.sum_duplicates()
        total = np.asarray(cells.sum(axis=1)).ravel()
        cells.data **= 2
        self.focus = np.asarray(cells.sum(axis=1)).ravel() / np.maximum(total, np.float32(1e-9)) ** 2
        self.depth = canvas.depth.copy()
        self._cuts: dict[tuple[int, int], _Cut] = {}

    def cut(self, rows: slice) -> _Cut:
        """Some successive rows; each batch comes up again in every sweep."""
        known = self._cuts.get((rows.start, rows.stop))
        if known is None:
            cover = _cut(self.cover, rows)
            known = _Cut(cover, cover.T, _cut(self.depths, rows).T)
            self._cuts[rows.start, rows.stop] = known
        return known

    def clear(self) -> NDArray[np.float32]:
        """Transparency (pixels + 1,); 0 beside the canvas, where nothing can be gained."""
        clear: NDArray[np.float32] = np.exp(-self.depth)
        clear[-1] = 0.0
        return clear

    def error(self, clear: NDArray[np.float32]) -> NDArray[np.float32]:
        """Wanted alpha less the rendered one (columns, rows), where anything is known."""
        return np.asarray(
            (self.canvas.wanted - 1.0 + self.canvas.cell_means(clear)) * self.canvas.known, np.float32
        )


class _Cut(NamedTuple):
    """A batch's rows of a view as the products take them: making a sparse matrix costs as much as a product.

    cover: (rows, pixels + 1).
    stand: (pixels + 1, rows), the same.
    deepen: (pixels + 1, rows) as optical depths.
    """

    cover: sparse.csr_array
    stand: sparse.csc_array
    deepen: sparse.csc_array


class _Seen(NamedTuple):
    """A view without a batch: transparency, error of the cells, and what each thing of it would show."""

    clear: NDArray[np.float32]
    wrong: NDArray[np.float32]
    shown: NDArray[np.float32]


def _pair(clear: NDArray[np.float32], wrong: NDArray[np.float32]) -> NDArray[np.float32]:
    """Transparency, and transparency times error, side by side: (pixels + 1, 2)."""
    both = np.empty((len(clear), 2), np.float32)
    both[:, 0] = clear
    np.multiply(clear, wrong, out=both[:, 1])
    return both


def _cut(matrix: sparse.csr_array, rows: slice) -> sparse.csr_array:
    """Some successive rows, without a copy."""
    first, last = matrix.indptr[rows.start], matrix.indptr[rows.stop]
    bounds = matrix.indptr[rows.start : rows.stop + 1] - first
    count = rows.stop - rows.start
    return sparse.csr_array(
        (matrix.data[first:last], matrix.indices[first:last], bounds), shape=(count, matrix.shape[1])
    )
