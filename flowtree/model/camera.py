"""How a photograph looks at the tree."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Camera:
    """A level camera that looks at the y axis; its picture is the plane through that axis which faces it.

    At yaw t it stands at (sin t, 0, cos t): at yaw 0 image-right is +x, at yaw 90 image-right is -z. What
    stands before or behind the plane is seen by parallel projection, or from an eye at a distance
    (`foreshorten`).

    Attributes:
        yaw: [degrees].
        metres_per_pixel: [m], of the working picture.
        foot: (x, y) [pixels] where the foot of the trunk projects; pixel centres lie at +0.5.
        width: of the picture [pixels].
        height: of the picture [pixels].
        distance: of the eye from the axis [m]; infinite for a parallel projection.
        eye: its height above the foot [m].
    """

    yaw: float
    metres_per_pixel: float
    foot: tuple[float, float]
    width: int
    height: int
    distance: float = math.inf
    eye: float = 0.0
