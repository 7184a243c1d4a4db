"""What an engine's shader shows of an octahedral impostor: the reference for writing one."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flowtree import check
from flowtree.geometry.octahedral_map import direction_to_square, level_axes, square_to_direction
from flowtree.model.asset import Card

Floats = NDArray[np.float64]
_LOOKS = 3  # for the depth where the line of sight meets the tree


def look_up_impostor(card: Card, toward: Floats, size: int) -> NDArray[np.float32]:
    """Draws an octahedral impostor as seen from a direction at or above the horizon, from far away.

    1. The direction's place on the hemi-octahedral map lies in a triangle of three neighbouring pictures;
       their barycentric weights blend them.
    2. The card is turned to the eye: a square around its middle, across ``toward``.
    3. Of each picture a pixel shows the texel whose point the line of sight passes: first on the plane
       through the middle across that picture's direction, then twice as high above that plane as the depth
       of the texel found before says (parallax, by fixed-point steps).
    4. The blended alpha is the share of the pixel that is tree: to be blended with what is behind, or drawn
       as so many of the pixels, by a comparison with noise (hashed alpha; Wyman and McGuire 2017). A test
       against one cut-off would lose twigs, which are elsewhere in each picture.

    Args:
        card: as `bake_octahedral` makes it.
        toward: (3,) from the tree to the eye.
        size: side of the picture [pixels].

    Returns: (size, size, 4) float32 in 0..1: colours as in the texture, not multiplied with alpha.

    Raises:
        InputError: a card of another kind.
    """
    check.require(card.name == "octahedral", "card", "must be octahedral", card.name, "bake that kind")
    eye = np.asarray(toward, np.float64) / np.linalg.norm(toward)
    axes = level_axes(eye)
    place = (np.arange(size) + 0.5) / size * 2.0 - 1.0
    x, y = np.meshgrid(place, -place)  # of the card's half side
    point = x[:, :, None] * axes[0] + y[:, :, None] * axes[1]
    shown = np.zeros((size, size, 4))
    for frame, weight in nearest_frames(eye, card.frames):
        grid = 2.0 * np.array([frame]) / (card.frames - 1) - 1.0
        picture = level_axes(square_to_direction(grid)[0])
        height = np.zeros((size, size))
        for _ in range(_LOOKS):
            # Along the line of sight to where it is as high above the picture's plane as what is seen there.
            step = (point @ picture[2] - height) / max(float(eye @ picture[2]), 1e-3)
            there = point - step[:, :, None] * eye
            texel = _sample(card, frame, 0.5 + 0.5 * (there @ picture[0]), 0.5 - 0.5 * (there @ picture[1]))
            height = texel[:, :, 4]
        # Where a picture shows nothing its colour does not count.
        shown[:, :, :3] += weight * texel[:, :, 3:4] * texel[:, :, :3]
        shown[:, :, 3] += weight * texel[:, :, 3]
    shown[:, :, :3] /= np.maximum(shown[:, :, 3:], 1e-6)
    return shown.astype(np.float32)


def nearest_frames(toward: Floats, frames: int) -> list[tuple[tuple[int, int], float]]:
    """The three pictures, as (column, row), around a direction (3,), and their weights, which sum to 1."""
    place = (direction_to_square(np.asarray(toward)[None])[0] + 1.0) * 0.5 * (frames - 1)
    low = np.clip(np.floor(place), 0, frames - 2).astype(int)
    x, y = np.clip(place - low, 0.0, 1.0)
    i, j = int(low[0]), int(low[1])
    third = ((i + 1, j), x - y) if x > y else ((i, j + 1), y - x)
    return [((i, j), float(1.0 - max(x, y))), ((i + 1, j + 1), float(min(x, y))), (third[0], float(third[1]))]


def _sample(card: Card, frame: tuple[int, int], u: Floats, v: Floats) -> Floats:
    """One picture at places (h, w) in 0..1, between its texels, and nothing outside.

    Returns: (h, w, 5) colour and alpha in 0..1, depth in half sides of the picture.
    """
    side = card.material.base_color.shape[0] // card.frames
    area = (slice(frame[1] * side, (frame[1] + 1) * side), slice(frame[0] * side, (frame[0] + 1) * side))
    assert card.material.normal is not None
    depth = card.material.normal[area][:, :, 3:] / 127.5 - 1.0
    texels = np.pad(
        np.concatenate([card.material.base_color[area] / 255.0, depth], axis=2),
        [(1, 1), (1, 1), (0, 0)],
        mode="edge",
    )
    inside = (u >= 0) & (u <= 1) & (v >= 0) & (v <= 1)
    x, y = np.clip(u, 0, 1) * side + 0.5, np.clip(v, 0, 1) * side + 0.5
    left, upper = np.floor(x).astype(int), np.floor(y).astype(int)
    fx, fy = (x - left)[:, :, None], (y - upper)[:, :, None]
    top = (1 - fx) * texels[upper, left] + fx * texels[upper, left + 1]
    bottom = (1 - fx) * texels[upper + 1, left] + fx * texels[upper + 1, left + 1]
    found: Floats = (1 - fy) * top + fy * bottom
    found[:, :, 3] *= inside
    return found
