"""Finds where the tree stands in its matte, and with that the camera."""

from __future__ import annotations

import math

from flowtree import check
from flowtree.model.camera import Camera
from flowtree.model.matte import Matte
from flowtree.photos.find_ends import find_ends

_LEAST_HEIGHT = 16.0  # [pixels]


def frame_view(
    matte: Matte,
    *,
    yaw: float,
    height: float,
    foot: tuple[float, float] | None = None,
    top: float | None = None,
) -> Camera:
    """An orthographic camera that sees the tree of the matte at its height.

    Foot and top that are not given are those of `find_ends`.

    Args:
        matte: of the view.
        yaw: [degrees].
        height: of the tree [m].
        foot: (x, y) [pixels] where the trunk leaves the ground; None finds it.
        top: row [pixels] where the crown ends; None finds it.

    Raises:
        InputError: an empty alpha, a height or yaw that is no such number, a foot outside the picture or not
            below the top, a tree lower than 16 pixels.
    """
    rows, columns = matte.alpha.shape
    tall = math.isfinite(height) and height > 0.0
    check.require(
        tall, "height", "must be a positive number of metres", f"{height:g}", "give the tree's height"
    )
    check.require(
        math.isfinite(yaw), "yaw", "must be a number of degrees", f"{yaw:g}", "give the view's angle"
    )
    # Either may be cut off by the picture's lower or upper edge.
    if foot is not None:
        inside = all(math.isfinite(v) for v in foot) and 0 <= foot[0] <= columns and 0 <= foot[1] <= 2 * rows
        check.require(
            inside,
            "foot",
            f"must lie in the picture ({columns} x {rows}) or less than its height below",
            foot,
            "give it in pixels",
        )
    if top is not None:
        inside = math.isfinite(top) and -rows <= top <= rows
        check.require(
            inside,
            "top",
            f"must be a row of the picture (0 to {rows}) or less than its height above",
            f"{top:g}",
            "give it in pixels",
        )
    if foot is None or top is None:
        found = find_ends(matte.alpha)
        foot = found.foot if foot is None else foot
        top = found.top if top is None else top
    check.require(
        foot[1] > top, "foot", "must lie below the top", f"row {foot[1]:g} and row {top:g}", "swap them"
    )
    pixels = foot[1] - top
    check.require(
        pixels >= _LEAST_HEIGHT,
        "tree",
        f"must be at least {_LEAST_HEIGHT:.0f} pixels high",
        f"{pixels:.1f}",
        "crop the photo around the tree or use a larger one",
    )
    return Camera(float(yaw), height / pixels, (float(foot[0]), float(foot[1])), columns, rows)
