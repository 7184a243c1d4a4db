"""How a photograph looks at the tree."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Camera:
    """An orthographic, level camera that looks at the y axis.

    At yaw t it stands at (sin t, 0, cos t): at yaw 0 image-right is +x, at yaw 90 image-right is -z.

    Attributes:
        yaw: [degrees].
        metres_per_pixel: [m], of the working picture.
        foot: (x, y) [pixels] where the foot of the trunk projects; pixel centres lie at +0.5.
        width: of the picture [pixels].
        height: of the picture [pixels].
    """

    yaw: float
    metres_per_pixel: float
    foot: tuple[float, float]
    width: int
    height: int
