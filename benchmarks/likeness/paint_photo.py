"""A cut-out tree before a painted sky: a photograph of which the matte is known."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from benchmarks.paint_backdrop import Stand, paint_backdrop
from flowtree.geometry.srgb import encode_srgb
from flowtree.model.photo import Photo
from flowtree.photos.load_photo import load_photo


@dataclass(frozen=True)
class Sky:
    """A weather: the seed of its clouds, and what light it gives, by which the backdrop is multiplied."""

    seed: int
    light: tuple[float, float, float]


#: Scattered clouds, a bright haze, and a dusk.
SKIES = {
    "clouds": Sky(25, (0.92, 0.92, 0.92)),
    "haze": Sky(20, (1.25, 1.2, 1.1)),
    "dusk": Sky(31, (0.72, 0.5, 0.42)),
}
# Around the cut-out picture [its heights], and what is below the foot.
_ROOM, _BELOW = 0.06, 0.05
_HEIGHT = 8.0  # of the tree [m]: it only sets how coarse the grass is
# The lens lies so low that the whole tree stands before the sky [m].
_EYE, _DISTANCE = 0.25, 22.0
_SUNLIT = np.ones((64, 64), np.float32)


def paint_photo(file: Path, sky: Sky) -> tuple[Photo, NDArray[np.float32]]:
    """The photograph (an opaque one) and its exact matte (h, w).

    Mixed as picture programs mix, by the shares of alpha in sRGB.
    """
    cutout = load_photo(file)
    assert cutout.alpha is not None, file
    rows = len(cutout.alpha)
    room, below = round(_ROOM * rows), round(_BELOW * rows)
    alpha = np.pad(cutout.alpha, ((room, below), (room, room)))
    alpha[rows + room :] = 0.0
    tree = np.pad(cutout.rgb, ((room, below), (room, room), (0, 0))).astype(np.float32) / 255.0
    lowest = int(np.flatnonzero((alpha > 0.5).any(axis=1))[-1]) + 1
    foot = float(np.flatnonzero(alpha[lowest - 1] > 0.5).mean()) + 0.5, float(lowest)
    stand = Stand(_DISTANCE, _EYE, rows / _HEIGHT, foot, alpha.shape[1], alpha.shape[0])
    behind = encode_srgb(
        np.clip(paint_backdrop(stand, _SUNLIT, 1.0, 1.0, sky.seed) * np.float32(sky.light), 0, 1)
    )
    mixed = tree * alpha[:, :, None] + behind * (1.0 - alpha[:, :, None])
    grain = np.random.default_rng(sky.seed).normal(0, 0.004, alpha.shape)[:, :, None]
    rgb = np.rint(255.0 * np.clip(mixed + grain, 0, 1)).astype(np.uint8)
    return Photo(f"{file.stem}.jpg", rgb), alpha.astype(np.float32)
