"""A tree made from exact mattes of a known one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from benchmarks.likeness.bench import Bench
from benchmarks.measure_truth import INPUTS, Truth, mark_ends
from flowtree.model.edit import PaintedEdit
from flowtree.pipeline.reconstruct import Reconstruction, reconstruct
from flowtree.render.render_mask import render_mask

_SAMPLES = 2  # rays along a pixel's side


def make_known(
    bench: Bench,
    truth: Truth,
    *,
    seed: int = 0,
    mattes: Mapping[int, NDArray[np.float32]] | None = None,
    strokes: Mapping[int, Sequence[NDArray[np.float32]]] | None = None,
    paint: Mapping[int, PaintedEdit] | None = None,
) -> Reconstruction:
    """The tree from the views at `INPUTS`, foot and top given.

    Args:
        bench: with parameters and cache.
        truth: the known tree.
        seed: of the run.
        mattes: in place of the exact ones, by the number of the view.
        strokes: drawn branches, by the number of the view.
        paint: painted edits, by the number of the view.
    """
    return reconstruct(
        [truth.photos[yaw] for yaw in INPUTS],
        yaws=INPUTS,
        height=truth.height,
        marks=[mark_ends(truth.cameras[yaw], truth.height) for yaw in INPUTS],
        mattes=mattes,
        strokes=None if strokes is None else {view: tuple(lines) for view, lines in strokes.items()},
        paint=paint,
        params=bench.params,
        seed=seed,
        cache=bench.cache,
    )


def see_alpha(made: Reconstruction, truth: Truth, yaw: int) -> NDArray[np.float32]:
    """What the made tree covers in the true camera of a view: (h, w) in 0..1."""
    return render_mask(made.tree, truth.cameras[yaw], samples=_SAMPLES)
