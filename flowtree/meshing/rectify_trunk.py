"""The trunk of a photograph, unrolled."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d

from flowtree.geometry.polylines import arc_lengths
from flowtree.geometry.projection import project
from flowtree.meshing.lower_trunk import lower_trunk
from flowtree.model.camera import Camera
from flowtree.model.matte import Matte
from flowtree.model.skeleton import Skeleton

_SAMPLES = 160  # places along the trunk
_FLARE = 1.2  # radii above the foot where the roots begin
_REACH = 2.4  # radii to each side that are looked at
_INSIDE = 0.5  # alpha
_SOLID = 0.9  # mean alpha within the trunk
_THINNER, _THICKER = 0.6, 1.5  # times the skeleton's width that the picture may show
HALF_TURN = np.radians(52.0)  # of the trunk's circumference to each side: beyond it bark is foreshortened
_GAP = 3  # places that may be missing

_Array = NDArray[np.float64]


@dataclass(frozen=True)
class TrunkPicture:
    """A picture in which bark can be seen.

    Attributes:
        rgb: (h, w, 3) uint8 sRGB, as fine as there is.
        matrix: (3, 3) from (x, y, 1) [pixels] of the view's camera to those of this picture, up to scale.
    """

    rgb: NDArray[np.uint8]
    matrix: NDArray[np.float64]


@dataclass(frozen=True)
class TrunkStrip:
    """The middle of a trunk, as if its bark were laid flat.

    Attributes:
        rgb: (h, w, 3) uint8 sRGB, the upper side toward the tip.
        metres_per_pixel: [m].
        turn: how much of the circumference it shows, 0..1.
    """

    rgb: NDArray[np.uint8]
    metres_per_pixel: float
    turn: float


def rectify_trunk(
    skeleton: Skeleton, matte: Matte, camera: Camera, picture: TrunkPicture
) -> TrunkStrip | None:
    """Unrolls the longest piece of the lower trunk that stands clear in a view.

    Where the trunk's edges lie the matte tells: a place counts where both are found, about as far apart as
    the skeleton is thick, all opaque between them and nothing of the tree beside them.

    Args:
        skeleton: with radii [m].
        matte: of the view.
        camera: of the view.
        picture: of the view.

    Returns: the strip, None where no piece as long as it is wide stands clear.
    """
    line, radius = lower_trunk(skeleton, _SAMPLES)
    centre = project(line, camera)
    wide = radius / camera.metres_per_pixel
    along = np.gradient(centre, axis=0)
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-9)
    across = np.stack([-along[:, 1], along[:, 0]], axis=1)  # to the right where the trunk leads up
    middle, half, clear = _find_edges(matte, centre, across, wide)
    clear &= line[:, 1] > _FLARE * radius[0]
    piece = _longest(clear)
    if piece is None or len(np.unique(centre[piece], axis=0)) < 4:
        return None
    known = np.flatnonzero(clear[piece])
    every = np.arange(piece.stop - piece.start)
    middle, half = (np.interp(every, known, values[piece][known]) for values in (middle, half))
    soft = max(2.0, 0.03 * len(every))
    middle, half = (gaussian_filter1d(values, soft, mode="nearest") for values in (middle, half))
    axis = centre[piece] + middle[:, None] * across[piece]
    fine = _scale_at(picture.matrix, axis.mean(axis=0))
    way = arc_lengths(axis)
    width = float(np.median(half)) * 2.0 * HALF_TURN
    if way[-1] < width:
        return None
    rows = np.linspace(way[-1], 0.0, max(2, round(float(way[-1]) * fine)))  # the upper side first
    angles = np.linspace(-HALF_TURN, HALF_TURN, max(2, round(width * fine)))
    at, beside, reach = (
        np.stack([np.interp(rows, way, values[:, k]) for k in range(values.shape[1])], axis=1)
        for values in (axis, across[piece], half[:, None])
    )
    place = at[:, None] + np.sin(angles)[None, :, None] * (reach * beside)[:, None]
    rgb = _sample(picture, place)
    return TrunkStrip(rgb, camera.metres_per_pixel / fine, float(HALF_TURN / np.pi))


def _find_edges(
    matte: Matte, centre: _Array, across: _Array, wide: _Array
) -> tuple[_Array, _Array, NDArray[np.bool_]]:
    """The trunk's middle beside each centre and half its width [pixels], and where both are known."""
    offset = np.linspace(-_REACH, _REACH, 97)
    place = centre[:, None] + (offset[None, :, None] * wide[:, None, None]) * across[:, None]
    flat = (place - 0.5).astype(np.float32)
    alpha = cv2.remap(matte.alpha, flat[..., 0], flat[..., 1], cv2.INTER_LINEAR, borderValue=0.0)
    if matte.unknown is not None:
        hidden = cv2.remap(
            matte.unknown.astype(np.float32), flat[..., 0], flat[..., 1], cv2.INTER_LINEAR, borderValue=1.0
        )
    else:
        hidden = np.zeros_like(alpha)
    solid = alpha > _INSIDE
    middle, half = np.zeros(len(centre)), np.ones(len(centre))
    clear = np.zeros(len(centre), bool)
    for k, row in enumerate(solid):
        edges = np.flatnonzero(np.diff(row.astype(np.int8), prepend=0, append=0))
        runs = [run for run in zip(edges[::2], edges[1::2], strict=True) if run[0] <= 48 < run[1]]
        if not runs or runs[0][0] == 0 or runs[0][1] == len(row):
            continue  # no trunk, or no end of it
        first, last = runs[0]
        step = offset[1] - offset[0]
        thick = (last - first) * step / 2.0
        inside = slice(first + 1, max(last - 1, first + 2))
        beside = np.delete(alpha[k], np.s_[max(first - 2, 0) : last + 2])
        clear[k] = (
            _THINNER <= thick <= _THICKER
            and float(alpha[k, inside].mean()) >= _SOLID
            and float(beside.mean()) < 0.25
            and float(hidden[k].max()) < 0.5
        )
        middle[k] = (offset[first] + offset[last - 1]) / 2.0 * wide[k]
        half[k] = thick * wide[k]
    return middle, half, clear


def _longest(clear: NDArray[np.bool_]) -> slice | None:
    """The longest run of clear places with no longer gaps than a few."""
    known = np.flatnonzero(clear)
    if len(known) < 2:
        return None
    pieces = np.split(known, np.flatnonzero(np.diff(known) > _GAP + 1) + 1)
    best = max(pieces, key=lambda piece: int(piece[-1] - piece[0]))
    return slice(int(best[0]), int(best[-1]) + 1) if len(best) > 1 else None


def _to_picture(matrix: _Array, places: _Array) -> _Array:
    """Places (..., 2) [camera pixels] in the picture's pixels."""
    moved = np.concatenate([places, np.ones((*places.shape[:-1], 1))], axis=-1) @ matrix.T
    return np.asarray(moved[..., :2] / moved[..., 2:])


def _scale_at(matrix: _Array, place: _Array) -> float:
    """Pixels of the picture per pixel of the camera at a place."""
    near = _to_picture(matrix, place + np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]))
    return float(np.sqrt(np.linalg.norm(near[1] - near[0]) * np.linalg.norm(near[2] - near[0])))


def _sample(picture: TrunkPicture, places: _Array) -> NDArray[np.uint8]:
    """The picture's colours (h, w, 3) at places (h, w, 2) [camera pixels]."""
    at = _to_picture(picture.matrix, places)
    low = np.clip(np.floor(at.min(axis=(0, 1))).astype(int) - 2, 0, None)
    high = np.ceil(at.max(axis=(0, 1))).astype(int) + 3
    part = np.ascontiguousarray(picture.rgb[low[1] : high[1], low[0] : high[0]])  # remap takes 32767 at most
    flat = (at - low - 0.5).astype(np.float32)
    return np.asarray(
        cv2.remap(part, flat[..., 0], flat[..., 1], cv2.INTER_CUBIC, borderMode=cv2.BORDER_REPLICATE),
        np.uint8,
    )
