"""What was drawn and pointed at in a photograph, in the level, parallel picture of its tree."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flowtree.model.marks import ViewMarks
from flowtree.model.placement import Placement

Polylines = tuple[NDArray[np.float32], ...]


def straighten_lines(
    strokes: Polylines, marks: ViewMarks, placement: Placement
) -> tuple[Polylines, ViewMarks]:
    """Moves places with their picture; nothing is touched where the placement has no warp.

    Args:
        strokes: polylines (k, 2) [pixels of the photograph], or (k, 3) with a brush's width.
        marks: of places in it.
        placement: of the tree in it.

    Returns: the same in pixels of ``placement.camera``.
    """
    if placement.warp is None:
        return strokes, marks
    back = np.asarray(np.linalg.inv(placement.warp), np.float64)
    foot = move_places(placement.warp, np.array([placement.camera.foot]))[0]

    def moved(line: NDArray[Any]) -> NDArray[np.float32]:
        return move_places(back, line).astype(np.float32)

    def redrawn(line: NDArray[Any]) -> NDArray[np.float32]:
        places, width = moved(line[:, :2]), line[:, 2:]
        if width.size:
            before, after = (_length(points) for points in (line[:, :2], places))
            width = width * (after / before if before > 0.0 else 1.0)
        return np.column_stack([places, width]).astype(np.float32)

    fork = None if marks.fork is None else move_places(back, np.array([marks.fork]))[0]
    top = None if marks.top is None else move_places(back, np.array([[foot[0], marks.top]]))[0]
    placed = replace(
        marks,
        foot=None if marks.foot is None else placement.camera.foot,
        top=None if top is None else float(top[1]),
        fork=None if fork is None else (float(fork[0]), float(fork[1])),
        seeds=moved(marks.seeds),
    )
    return tuple(redrawn(line) for line in strokes), placed


def _length(points: NDArray[Any]) -> float:
    return float(np.linalg.norm(np.diff(points.astype(np.float64), axis=0), axis=1).sum())


def move_places(matrix: NDArray[np.float64], points: NDArray[Any]) -> NDArray[np.float64]:
    """A (3, 3) map between pictures applied to places (k, 2) [pixels]."""
    moved = np.c_[points.astype(np.float64), np.ones(len(points))] @ matrix.T
    return np.asarray(moved[:, :2] / moved[:, 2:], np.float64).reshape(-1, 2)
