"""Chooses among many small things those that together show in each view what it should."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import scipy.sparse as sparse
from numpy.typing import NDArray

from flowtree import device as devices
from flowtree.geometry.cover_canvas import CoverCanvas
from flowtree.kernels import choose_cover as kernels

_SWEEPS = 4


def choose_cover(
    canvases: Sequence[CoverCanvas],
    covers: Sequence[sparse.csr_array],
    *,
    batch: NDArray[np.integer],
    chance: NDArray[np.float64],
    start: NDArray[np.bool_] | None = None,
    weight: NDArray[np.float64] | None = None,
    most: int | None = None,
    sweeps: int = _SWEEPS,
) -> NDArray[np.bool_]:
    """Which things stay, so that the alpha of those that do comes near the wanted one in every cell.

    A closed loop of rendering, comparing and correcting: a batch of things is taken away, the rest is
    rendered (the transparencies of what covers a pixel multiply), and each thing of the batch is put back if
    it lowers the squared error over the cells of all views. Where several would fill the same gap, they are
    put back with the share of them that fills it as probability: those whose ``chance`` is below it. After
    some sweeps over all batches little moves any more.

    All that decides about a thing is its own chance and what is seen where it is: a change in one place of a
    matte changes the choice there and hardly elsewhere.

    Args:
        canvases: one a view.
        covers: one a view, (n, pixels + 1) shares of pixels.
        batch: (n,) from 0, random; things of one batch do not see each other.
        chance: (n,) in 0..1, each thing's own random number.
        start: (n,) what is there before the first sweep; None for nothing.
        weight: (n,) in 0..1, factors to the probabilities until the last two sweeps: likelier things first.
        most: that may stay: where more would, those that gain least have to go; None for no limit.
        sweeps: over all batches.

    Returns: (n,) which stay.
    """
    if not len(batch):
        return np.zeros(0, np.bool_)
    loop = _Loop(canvases, covers, batch, 1)
    there = np.zeros(len(batch), np.int32) if start is None else start[loop.order].astype(np.int32)
    loop.put(np.where(there, 0, -1))
    gain, least = np.zeros(len(batch), np.float32), 0.0
    luck = chance[loop.order].astype(np.float32)
    likely = np.ones_like(luck) if weight is None else weight[loop.order].astype(np.float32)
    for sweep in range(sweeps):
        factor = likely if sweep < sweeps - 2 else np.ones_like(luck)
        inputs = [loop.table, loop.batch, _over(luck), _over(factor), least]
        loop.launch(kernels.sweep_cover, inputs, [loop.state, _over(there), _over(gain)])
        least = max(least, _least_worth(gain[there != 0], most))
    kept = np.zeros(len(batch), np.bool_)
    kept[loop.order] = (there != 0) & (gain > least)
    return kept


def _least_worth(worth: NDArray[np.float32], most: int | None) -> float:
    """What all but ``most`` of them do not exceed."""
    if most is None or len(worth) <= most:
        return 0.0
    return float(np.partition(worth, -most - 1)[-most - 1]) if most else float(worth.max())


def choose_poses(
    canvases: Sequence[CoverCanvas],
    covers: Sequence[sparse.csr_array],
    *,
    poses: int,
    batch: NDArray[np.integer],
    contented: float,
    sweeps: int = 3,
) -> NDArray[np.int64]:
    """The pose of each thing with which all come near the wanted alpha, or none: `choose_cover` with poses.

    Args:
        canvases: one a view.
        covers: one a view, (n * poses, pixels + 1), the poses of a thing one after the other.
        poses: of each thing; it starts in the first.
        batch: (n,) from 0, random.
        contented: a thing stays in a pose that does at least this share of what the best one would do.
        sweeps: over all batches.

    Returns: (n,) the pose, -1 where a thing does harm in every pose.
    """
    if not len(batch):
        return np.zeros(0, np.int64)
    loop = _Loop(canvases, covers, batch, poses)
    pose = np.zeros(len(batch), np.int32)
    loop.put(pose)
    for _ in range(sweeps):
        loop.launch(kernels.sweep_poses, [loop.table, loop.batch, contented], [loop.state, _over(pose)])
    result = np.empty(len(batch), np.int64)
    result[loop.order] = pose
    return result


class _Loop:
    """What things cover and what is rendered, as the kernels take it; in the batches' order.

    They run on one core of the processor, whatever the device: each batch waits for the one before, and the
    other cores have other stages to do.

    Attributes:
        order: (n,) the things' old numbers.
        batch: where each batch begins.
        table: what the things cover.
        state: what is rendered.
    """

    def __init__(
        self,
        canvases: Sequence[CoverCanvas],
        covers: Sequence[sparse.csr_array],
        batch: NDArray[np.integer],
        poses: int,
    ) -> None:
        self.order = np.argsort(batch, kind="stable")
        self.batch = _over(np.append(0, np.cumsum(np.bincount(batch))).astype(np.int32))
        rows = (self.order[:, None] * poses + np.arange(poses)).ravel()
        # A batch's rows side by side in memory: scattered, each would be waited for.
        self._covers = [cover[rows] for cover in covers]
        self.table = _list_covers(canvases, self._covers, poses)
        self._canvases = canvases
        self.state = kernels.CoverState()

    def put(self, pose: NDArray[np.integer]) -> None:
        """Renders all things in the given poses (n,), -1 for those that are not there."""
        present = np.zeros((len(pose), self.table.poses), np.float32)
        there = np.flatnonzero(pose >= 0)
        present[there, pose[there]] = 1.0
        depths, clears, wrongs = [], [], []
        for canvas, cover in zip(self._canvases, self._covers, strict=True):
            deepen = sparse.csr_array((-np.log1p(-cover.data), cover.indices, cover.indptr), cover.shape)
            depth = canvas.depth + deepen.T @ present.ravel()
            depth[-1] = np.inf  # beside the picture nothing can be gained
            clear = np.exp(-depth)
            wrong = (canvas.wanted - 1.0 + canvas.cell_means(clear)) * canvas.known
            depths.append(depth)
            clears.append(clear)
            wrongs.append(np.append(wrong, 0.0))
        lists = {"depth": depths, "clear": clears, "wrong": wrongs, "together": wrongs}
        for name, parts in lists.items():
            setattr(self.state, name, _over(np.concatenate(parts).astype(np.float32)))
        self.state.shown = _over(np.empty(present.size * len(depths), np.float32))

    @staticmethod
    def launch(kernel: Any, inputs: Sequence[Any], outputs: Sequence[Any]) -> None:
        """One sweep over all batches."""
        devices.launch(kernel, 1, inputs, outputs, device="cpu")


def _over(values: NDArray[Any]) -> Any:
    """The values as a kernel takes them, in the same memory."""
    return devices.hand_over(values, int if values.dtype == np.int32 else float, "cpu")


def _list_covers(canvases: Sequence[CoverCanvas], covers: Sequence[sparse.csr_array], poses: int) -> Any:
    """The rows of all views, one view after the other; so stand their pixels and cells."""
    views = list(zip(canvases, covers, strict=True))
    cells = [canvas.cell_index(cover.indices) for canvas, cover in views]
    share = np.concatenate([cover.data for cover in covers])
    lists = {
        "start": np.append(0, np.cumsum(np.concatenate([np.diff(cover.indptr) for cover in covers]))),
        "pixel": _one_after_another([c.indices for c in covers], [len(c.depth) for c in canvases]),
        "cell": _one_after_another(cells, [canvas.wanted.size + 1 for canvas in canvases]),
        "share": share,
        "depth": -np.log1p(-share),
        "focus": np.concatenate([_focus(cover, cell) for cover, cell in zip(covers, cells, strict=True)]),
        "known": np.concatenate([np.append(canvas.known, 0.0) for canvas in canvases]),
    }
    table = kernels.CoverViews()
    table.views, table.poses = len(views), poses
    for name, values in lists.items():
        kind = np.int32 if np.issubdtype(values.dtype, np.integer) else np.float32
        setattr(table, name, _over(np.ascontiguousarray(values, kind)))
    return table


def _one_after_another(numbers: Sequence[NDArray[np.int32]], counts: Sequence[int]) -> NDArray[np.int32]:
    """The views' numbers as those of all views, of which each has so many."""
    before = np.cumsum([0, *counts[:-1]])
    return np.concatenate([own + np.int32(first) for own, first in zip(numbers, before, strict=True)])


def _focus(cover: sparse.csr_array, cell: NDArray[np.int32]) -> NDArray[np.float32]:
    """Sum of squares of each row's shares of the cells (rows,): 1 where all of it lies in one cell."""
    shape = (cover.shape[0], int(cell.max(initial=0)) + 1)
    shares = sparse.csr_array((cover.data.copy(), cell.copy(), cover.indptr.copy()), shape)
    shares.sum_duplicates()
    total = np.asarray(shares.sum(axis=1)).ravel()
    shares.data **= 2
    squares = np.asarray(shares.sum(axis=1)).ravel()
    return np.asarray(squares / np.maximum(total, np.float32(1e-9)) ** 2, np.float32)
