"""Marks: what a person points at in one view."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class ViewMarks:
    """Places in one view that are given instead of found, in pixels of its working picture.

    Attributes:
        foot: (x, y) [pixels] where the trunk leaves the ground; None is found in the matte.
        top: row [pixels] where the crown ends; None is found in the matte.
        fork: (x, y) [pixels] of the trunk's first fork, to which all attractor paths lead; None is the foot.
        seeds: (k, 2) float32 (x, y) [pixels], tips of branches from which attractor paths start.
        roll: [degrees] by which the picture's verticals lean to the right; None is estimated.
        distance: of the camera from the tree [m]; None goes by the focal length.
        focal_length: of the lens, as on a 36 x 24 mm film [mm]; None is what the file says.
    """

    foot: tuple[float, float] | None = None
    top: float | None = None
    fork: tuple[float, float] | None = None
    seeds: NDArray[np.float32] = field(default_factory=lambda: np.zeros((0, 2), np.float32))
    roll: float | None = None
    distance: float | None = None
    focal_length: float | None = None
