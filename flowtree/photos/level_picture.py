"""A picture turned about the foot of its tree until its verticals stand upright."""

from __future__ import annotations

import math

import cv2
import numpy as np
from numpy.typing import NDArray


def roll_matrix(foot: tuple[float, float], roll: float) -> NDArray[np.float64]:
    """(3, 3) from (x, y, 1) [pixels] of the level picture to those of the photograph; the foot stays.

    Args:
        foot: (x, y) [pixels] about which the picture turns.
        roll: [degrees] by which the photograph's verticals lean to the right.
    """
    sine, cosine = math.sin(math.radians(roll)), math.cos(math.radians(roll))
    turn = np.array([[cosine, -sine], [sine, cosine]])
    matrix = np.eye(3)
    matrix[:2, :2] = turn
    matrix[:2, 2] = np.array(foot) - turn @ np.array(foot)
    return matrix


def level_picture(
    picture: NDArray[np.float32], foot: tuple[float, float], roll: float
) -> tuple[NDArray[np.float32], int]:
    """The picture without its roll, on a sheet large enough for all of it.

    Args:
        picture: (h, w).
        foot: (x, y) [pixels] about which it turns.
        roll: [degrees] by which its verticals lean to the right.

    Returns: the level picture, nothing (0) outside of the old one, and the row [pixels] in it from which rows
        are counted as in the old one, so that the foot keeps its own.
    """
    if roll == 0.0:
        return picture, 0
    rows, columns = picture.shape
    to_level = np.linalg.inv(roll_matrix(foot, roll))
    corners = to_level[:2] @ np.array([[0, columns, 0, columns], [0, 0, rows, rows], [1, 1, 1, 1]], float)
    low, high = np.floor(corners.min(axis=1)).astype(int), np.ceil(corners.max(axis=1)).astype(int)
    # OpenCV counts pixel centres from 0.
    matrix = pixel_centres(roll_matrix(foot, roll) @ _shift(float(low[0]), float(low[1])))
    size = (int(high[0] - low[0]), int(high[1] - low[1]))
    flags = cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
    level = cv2.warpAffine(picture, matrix[:2], size, flags=flags)
    return np.asarray(level, np.float32), -int(low[1])


def pixel_centres(matrix: NDArray[np.float64]) -> NDArray[np.float64]:
    """A (3, 3) map between pictures whose pixel centres lie at +0.5, for centres at whole numbers."""
    return _shift(-0.5, -0.5) @ matrix @ _shift(0.5, 0.5)


def _shift(x: float, y: float) -> NDArray[np.float64]:
    return np.array([[1.0, 0.0, x], [0.0, 1.0, y], [0.0, 0.0, 1.0]])
