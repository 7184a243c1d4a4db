"""What a photograph shows, coarsely, of the plane through its tree's axis, wherever that is said to be."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from flowtree.geometry.footprint_means import optical_depth
from flowtree.model.matte import Matte
from flowtree.model.placement import Placement
from flowtree.photos.adjust_placement import adjustment, plane_to_pixels
from flowtree.photos.level_picture import pixel_centres
from flowtree.photos.straighten_lines import move_places

_FINE = 3  # samples along a cell's side
_KNOWN = 0.99  # of a cell


@dataclass(frozen=True)
class CoarseMatte:
    """A matte, shrunk until a pixel is about as large as a sample.

    Attributes:
        alpha: (h, w).
        known: (h, w) in 0..1; outside of it is 0 where the tree leaves the frame.
        shrink: pixels of the photograph in one of it, along x and y.
        outside: what is known beyond the frame.
    """

    alpha: NDArray[np.float32]
    known: NDArray[np.float32]
    shrink: tuple[float, float]
    outside: float


def shrink_matte(matte: Matte, placement: Placement, cell: float) -> CoarseMatte:
    """The matte as coarse as cells of the plane [m] need it."""
    sample = cell / _FINE
    rows, columns = matte.alpha.shape
    # Pixels of the photograph in a sample, at the foot.
    step = plane_to_pixels(placement) @ np.array([[0.0, sample], [0.0, 0.0], [1.0, 1.0]])
    ends = step[:2].T if placement.warp is None else move_places(placement.warp, step[:2].T)
    ratio = max(1.0, float(np.linalg.norm(ends[1] - ends[0])))
    size = (max(1, round(columns / ratio)), max(1, round(rows / ratio)))
    known = np.ones_like(matte.alpha) if matte.unknown is None else (~matte.unknown).astype(np.float32)
    alpha, sure = (
        np.asarray(cv2.resize(values, size, interpolation=cv2.INTER_AREA), np.float32)
        for values in (matte.alpha, known)
    )
    return CoarseMatte(alpha, sure, (columns / size[0], rows / size[1]), 0.0 if placement.missing else 1.0)


def look_at_plane(
    picture: CoarseMatte,
    placement: Placement,
    turns: Mapping[str, float],
    *,
    height: float,
    cell: float,
    half: int,
    rows: int,
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Optical depth of the cells of a view's plane under corrections of its placement.

    Args:
        picture: of the view.
        placement: of its photograph.
        turns: corrections by name, see `adjust_placement`.
        height: of the tree [m].
        cell: edge of a cell [m].
        half: cells to either side of the axis.
        rows: cells up from the ground.

    Returns: (2 half, rows) depths, row 0 on the ground, and which of them are known.
    """
    sample = cell / _FINE
    columns, fine = 2 * half * _FINE, rows * _FINE
    to_plane = np.array([[sample, 0.0, -half * cell], [0.0, -sample, fine * sample], [0.0, 0.0, 1.0]])
    to_photo = np.eye(3) if placement.warp is None else placement.warp
    matrix = to_photo @ plane_to_pixels(placement) @ adjustment(turns, height) @ to_plane
    matrix = np.diag([1.0 / picture.shrink[0], 1.0 / picture.shrink[1], 1.0]) @ matrix
    alpha, known = (
        cv2.warpPerspective(
            values,
            pixel_centres(matrix),
            (columns, fine),
            flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP,
            borderMode=cv2.BORDER_CONSTANT,
            borderValue=beyond,
        )
        .reshape(rows, _FINE, -1, _FINE)
        .mean(axis=(1, 3))[::-1]
        .T
        for values, beyond in ((picture.alpha, 0.0), (picture.known, picture.outside))
    )
    return optical_depth(alpha.astype(np.float64)), known > _KNOWN
