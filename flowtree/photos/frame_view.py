"""Finds where the tree stands in its matte, and with that the camera."""

from __future__ import annotations

import math

import cv2
import numpy as np
from numpy.typing import NDArray

from flowtree import check
from flowtree.model.camera import Camera
from flowtree.model.matte import Matte

_SOLID = 0.35  # alpha of a pixel that counts; twigs thinner than a pixel still reach it
_LEAST_HEIGHT = 16.0  # [pixels]
_WIDE = 0.25  # of the tree's height: the last rows of a stem are narrower
_FOOT_ROWS = 0.03  # of the tree's height: the stretch that says where the trunk's middle is


def frame_view(
    matte: Matte,
    *,
    yaw: float,
    height: float,
    foot: tuple[float, float] | None = None,
    top: float | None = None,
) -> Camera:
    """An orthographic camera that sees the tree of the matte at its height.

    Foot and top are those of the largest thing in the matte and of what lies near it: specks count for
    nothing. The foot is the middle of the trunk in its last rows; where the crown comes down to the ground it
    is below the middle of the whole tree. The top is the highest row with a solid pixel.

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
    if foot is not None:
        inside = all(math.isfinite(v) for v in foot) and 0 <= foot[0] <= columns and 0 <= foot[1] <= rows
        check.require(
            inside, "foot", f"must lie in the picture ({columns} x {rows})", foot, "give it in pixels"
        )
    if top is not None:
        inside = math.isfinite(top) and 0 <= top <= rows
        check.require(
            inside, "top", f"must be a row of the picture (0 to {rows})", f"{top:g}", "give it in pixels"
        )
    if foot is None or top is None:
        found_foot, found_top = _find_ends(matte.alpha)
        foot = found_foot if foot is None else foot
        top = found_top if top is None else top
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


def _find_ends(alpha: NDArray[np.float32]) -> tuple[tuple[float, float], float]:
    """The foot (x, y) and the top row of the tree [pixels]."""
    solid = _tree_of(alpha)
    rows = np.flatnonzero(solid.any(axis=1))
    check.require(
        len(rows) > 0, "matte", "must show a tree", "an empty alpha", "check the matte of this photo"
    )
    first, last = int(rows[0]), int(rows[-1])
    tall = last + 1 - first
    weight = np.where(solid, alpha, 0.0).astype(np.float64)
    mass = weight.sum(axis=1)
    # The last row that carries its share: a root or a blade of grass hangs lower than the trunk ends.
    near = mass[max(first, last - round(0.1 * tall)) : last + 1]
    enough = 0.3 * float(np.median(near[near > 0.0]))
    while last > first and mass[last] < enough:
        last -= 1
    low = weight[max(first, last - round(_FOOT_ROWS * tall)) : last + 1].sum(axis=0)
    if _quantile(low, 0.9) - _quantile(low, 0.1) > _WIDE * tall:  # a crown down to the ground hides the stem
        x = float(np.median([_quantile(row, 0.5) for row in weight[first : last + 1] if row.any()]))
    else:
        x = _quantile(low, 0.5)  # the median is the stem's even where a branch hangs beside it
    return (x, float(last + 1)), float(first)


def _quantile(mass: NDArray[np.float64], share: float) -> float:
    """Where along a row of pixels the given share of its mass is reached."""
    run = np.cumsum(mass) / max(float(mass.sum()), 1e-9)
    column = int(np.searchsorted(run, share))
    before = float(run[column - 1]) if column else 0.0
    return float(column + (share - before) / max(float(run[column]) - before, 1e-9))


def _tree_of(alpha: NDArray[np.float32]) -> NDArray[np.bool_]:
    """The solid pixels of the largest thing, with the leaves that float near it."""
    solid = alpha > _SOLID
    reach = 2 * max(1, round(0.01 * alpha.shape[0])) + 1
    joined = cv2.dilate(solid.astype(np.uint8), np.ones((reach, reach), np.uint8))
    count, parts = cv2.connectedComponents(joined, connectivity=8)
    mass = np.bincount(parts.ravel(), np.where(solid, alpha, 0.0).ravel(), count)
    mass[0] = 0.0
    largest: NDArray[np.bool_] = solid & (parts == int(mass.argmax())) & (parts > 0)
    return largest
