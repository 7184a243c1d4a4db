"""How the tree stands in one photograph, and how sure that is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flowtree.model.camera import Camera


@dataclass(frozen=True)
class Estimate:
    """One number about a view and where it came from.

    Attributes:
        name: what it is: "foot", "top" (rows of the working picture), "roll", "distance", "yaw".
        value: of the photograph.
        unit: of the value.
        origin: "given", "EXIF", "estimated" (from the pictures) or "assumed" (a usual value).
        deviation: one standard deviation, in the same unit; None where it is exact or nobody knows.
    """

    name: str
    value: float
    unit: str
    origin: str
    deviation: float | None = None


@dataclass(frozen=True)
class Placement:
    """Where one view's tree stands, and how its photograph becomes a level, parallel picture of it.

    Attributes:
        camera: of the straightened picture; its size is the picture's.
        warp: (3, 3) float64 that takes (x, y, 1) [pixels] of the straightened picture to those of the
            photograph, up to scale; None where the photograph is that picture already.
        frame: (columns, rows) of the photograph.
        missing: sides of the photograph, of "left", "right", "top", "bottom", where the tree leaves it.
        estimates: what the camera was made from.
        warnings: what a person should look at, in words.
        open: names of those estimates, and "yaw", that nobody gave and the other views may still correct.
    """

    camera: Camera
    warp: NDArray[np.float64] | None = None
    frame: tuple[int, int] = (0, 0)
    missing: tuple[str, ...] = ()
    estimates: tuple[Estimate, ...] = ()
    warnings: tuple[str, ...] = ()
    open: tuple[str, ...] = ()
