"""Colours or normals from a texture, at the size at which it is seen."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flowtree.geometry.srgb import LIGHT_OF_BYTE

_LIGHT = LIGHT_OF_BYTE.astype(np.float32)


def build_pyramid(texture: NDArray[np.uint8]) -> list[NDArray[np.float32]]:
    """The texture in linear light, halved again and again; a fourth channel weighs the others.

    Args:
        texture: (h, w, 3 or 4) uint8 sRGB.

    Returns: the levels (h, w, 3) float32, the finest first.
    """
    weight = (
        texture[:, :, 3:].astype(np.float32) if texture.shape[2] == 4 else np.ones((*texture.shape[:2], 1))
    )
    weight = weight.astype(np.float32) + np.float32(1e-3)
    color = _LIGHT[texture[:, :, :3]] * weight
    levels = [color / weight]
    while max(color.shape[:2]) > 1:
        color, weight = _halve(color), _halve(weight)
        levels.append(color / weight)
    return levels


def build_normal_pyramid(texture: NDArray[np.uint8]) -> list[NDArray[np.float32]]:
    """A normal map (h, w, 3) as vectors, halved again and again: shorter where it is rough."""
    levels = [texture.astype(np.float32) / np.float32(127.5) - np.float32(1)]
    while max(levels[-1].shape[:2]) > 1:
        levels.append(_halve(levels[-1]))
    return levels


def sample_texture(
    levels: list[NDArray[np.float32]], uv: NDArray[np.float32], level: NDArray[np.integer]
) -> NDArray[np.float32]:
    """Colours, or normals, (n, 3) at (n, 2) coordinates between texels, of a level each; textures repeat."""
    colors = np.empty((len(uv), 3), np.float32)
    for number, picture in enumerate(levels):
        chosen = np.flatnonzero(level == number)
        if not len(chosen):
            continue
        rows, columns = picture.shape[:2]
        x = uv[chosen, 0] * np.float32(columns) - np.float32(0.5)
        y = uv[chosen, 1] * np.float32(rows) - np.float32(0.5)
        left, upper = np.floor(x).astype(np.int32), np.floor(y).astype(np.int32)
        fx, fy = (x - left)[:, None], (y - upper)[:, None]
        flat = picture.reshape(-1, 3)
        i, i_next = left % columns, (left + 1) % columns
        j, j_next = upper % rows * columns, (upper + 1) % rows * columns
        shares = (
            (j + i, (1 - fx) * (1 - fy)),
            (j + i_next, fx * (1 - fy)),
            (j_next + i, (1 - fx) * fy),
            (j_next + i_next, fx * fy),
        )
        colors[chosen] = sum(np.take(flat, texel, axis=0) * share for texel, share in shares)
    return colors


def _halve(picture: NDArray[np.float32]) -> NDArray[np.float32]:
    """The means of two by two texels; a last odd row or column is repeated."""
    odd = [(0, side % 2) for side in picture.shape[:2]]
    even = np.pad(picture, [*odd, (0, 0)], "edge")
    four = even[::2, ::2] + even[1::2, ::2] + even[::2, 1::2] + even[1::2, 1::2]
    return np.asarray(four / np.float32(4), np.float32)
