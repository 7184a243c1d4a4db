"""Whether two mattes can be of one tree."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from flowtree import check
from flowtree.model.camera import Camera
from flowtree.model.matte import Matte

_ROWS = 32
# Opaque pixels would hold infinite depth: what one pixel can tell ends here.
_MOST_ALPHA = 0.98
# Views of one tree agree to 0.65 and more, of different trees to 0.23 and more: less is no pair at all.
_NO_PAIR = 0.2


def compare_views(
    matte: Matte, camera: Camera, other: Matte, other_camera: Camera, *, height: float
) -> float:
    """How alike the two views' profiles of optical depth over height are: 1 equal, 0 nothing in common.

    A level slice of a tree holds one amount of leaf and wood, from wherever it is seen, so the row sums of
    optical depth agree between views of one tree. Each profile is taken as shares of its own total (photos
    differ in contrast); the result is ``sum(min) / sum(max)`` over rows of 1/32 of the height.
    """
    first, second = (_profile(m, c, height) for m, c in ((matte, camera), (other, other_camera)))
    return float(np.minimum(first, second).sum() / np.maximum(first, second).sum())


def check_same_tree(
    names: Sequence[str], mattes: Sequence[Matte], cameras: Sequence[Camera], *, height: float
) -> None:
    """Refuses views that do not match at all; what is only doubtful is left to the report.

    Raises:
        InputError: two views whose profiles over height have almost nothing in common.
    """
    for a, b in combinations(range(len(names)), 2):
        alike = compare_views(mattes[a], cameras[a], mattes[b], cameras[b], height=height)
        check.require(
            alike >= _NO_PAIR,
            names[b],
            f"must show the same tree as {names[a]}",
            f"profiles over height that agree to {alike:.0%}",
            "check both mattes with flowtree matte, or scribble the tree",
        )


def _profile(matte: Matte, camera: Camera, height: float) -> NDArray[np.float64]:
    """(rows,) shares of the optical depth, from the foot up; of equal shares where there is none."""
    depth = -np.log1p(-np.minimum(matte.alpha.astype(np.float64), _MOST_ALPHA)).sum(axis=1)
    above = (camera.foot[1] - np.arange(camera.height) - 0.5) * camera.metres_per_pixel / height
    inside = (above >= 0.0) & (above < 1.0)
    sums = np.bincount((above[inside] * _ROWS).astype(int), depth[inside], minlength=_ROWS)
    total = float(sums.sum())
    return np.asarray(sums / total if total > 0 else np.full(_ROWS, 1.0 / _ROWS), np.float64)
