"""Whether a hole in one matte stays a hole in the tree."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from benchmarks.likeness.bench import Bench, Row
from benchmarks.likeness.make_known import make_known, see_alpha
from benchmarks.likeness.show_sheet import show_sheet
from benchmarks.measure_truth import INPUTS, Truth, load_truth

_ASKED = 0.15
_AREA = 0.1  # of the crown's
_CLOSING = 0.04  # gaps so wide belong to the crown [tree heights]


def measure_holes(bench: Bench, names: Sequence[str]) -> list[Row]:
    """A round hole in the first view's exact matte: mean alpha of the tree inside it, the worst tree's."""
    seen, before = {}, {}
    for name in names:
        truth = load_truth(bench.data / "truth" / name)
        yaw = INPUTS[0]
        hole = place_hole(truth, yaw)
        alpha = np.where(hole, np.float32(0), truth.alphas[yaw])
        made = make_known(bench, truth, mattes={0: alpha})
        show_sheet(bench, f"hole_{name}", made)
        seen[name] = float(see_alpha(made, truth, yaw)[hole].mean())
        before[name] = float(truth.alphas[yaw][hole].mean())
    return [
        Row("alpha in a hole of a tenth of the crown, worst", _ASKED, max(seen.values()), seen, at_most=True),
        Row("what the true tree has there", None, max(before.values()), before),
    ]


def place_hole(truth: Truth, yaw: int) -> NDArray[np.bool_]:
    """A disc (h, w) inside the crown: where the crown is densest, beside the trunk where there is room.

    Sky that is seen through a crown is seen beside its trunk; in a narrow crown the disc lies as far from the
    trunk as it can.
    """
    alpha, camera = truth.alphas[yaw], truth.cameras[yaw]
    unit = truth.height / camera.metres_per_pixel
    brush = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (round(_CLOSING * unit) | 1,) * 2)
    crown = cv2.morphologyEx((alpha > 0.5).astype(np.uint8), cv2.MORPH_CLOSE, brush)
    radius = float(np.sqrt(_AREA * crown.sum() / np.pi))
    room = cv2.distanceTransform(np.pad(crown, 1), cv2.DIST_L2, 5)[1:-1, 1:-1]
    row, column = np.mgrid[: alpha.shape[0], : alpha.shape[1]] + 0.5
    beside = np.abs(column - camera.foot[0])
    fits = room >= min(radius, float(room.max()))
    clear = fits & (beside >= radius)
    around = round(radius) * 2 + 1
    dense = cv2.blur(alpha, (around, around))
    place = np.where(clear, dense, -1.0) if clear.any() else np.where(fits, beside, -1.0)
    middle = np.unravel_index(int(place.argmax()), place.shape)
    return (row - middle[0] - 0.5) ** 2 + (column - middle[1] - 0.5) ** 2 <= radius**2
