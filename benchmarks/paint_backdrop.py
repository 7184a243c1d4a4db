"""Sky, clouds, hills and a meadow behind and under a tree: painted, no photograph."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

Picture = NDArray[np.float32]


@dataclass(frozen=True)
class Stand:
    """Where the photographer stands, and how the tree lies in the picture.

    Attributes:
        distance: from the tree [m].
        eye: height of the lens over the ground [m].
        scale: pixels in a metre at the tree's distance.
        foot: (x, y) [pixels] of the tree's foot.
        width: of the picture [pixels].
        height: of the picture [pixels].
    """

    distance: float
    eye: float
    scale: float
    foot: tuple[float, float]
    width: int
    height: int


def paint_backdrop(
    stand: Stand, shadow: NDArray[np.float32], cell: float, sun_side: float, seed: int
) -> Picture:
    """Paints what stands behind the tree.

    Args:
        stand: of the photographer.
        shadow: (n, n) the share of sunlight on the ground, around the foot; rows away from the camera.
        cell: of the shadow [m].
        sun_side: -1 when the sun stands on the left, 1 on the right: there the sky is brighter.
        seed: of clouds and grass.

    Returns: (height, width, 3) float32, linear.
    """
    rng = np.random.default_rng(seed)
    row, column = np.mgrid[: stand.height, : stand.width].astype(np.float32) + 0.5
    horizon = stand.foot[1] - stand.eye * stand.scale
    picture = _paint_sky(row / horizon, column / stand.width, sun_side, rng)
    _paint_hills(picture, horizon, stand, rng)
    _paint_meadow(picture, row, column, horizon, stand, shadow, cell, rng)
    return picture


def _noise(rng: np.random.Generator, shape: tuple[int, int], size: float, aspect: float = 1.0) -> Picture:
    """Smooth noise of several octaves, mean 0, spread about 1; ``size`` [pixels] of the coarsest."""
    total = np.zeros(shape, np.float32)
    for octave in range(6):
        grain = max(size / 2**octave, 1.0)
        cells = [max(2, int(shape[0] / grain * aspect) + 3), max(2, int(shape[1] / grain) + 3)]
        layer = cv2.resize(
            rng.normal(size=cells).astype(np.float32), shape[::-1], interpolation=cv2.INTER_CUBIC
        )
        total += layer * np.float32(0.55**octave)
    return (total - total.mean()) / (total.std() + np.float32(1e-6))


def _paint_sky(down: Picture, across: Picture, sun_side: float, rng: np.random.Generator) -> Picture:
    depth = np.clip(down, 0, 1)[:, :, None] ** 1.4
    blue = (1 - depth) * np.array([0.17, 0.36, 0.78]) + depth * np.array([0.58, 0.74, 0.93])
    blue = blue * (1 + 0.10 * sun_side * (across[:, :, None] - 0.5))
    shape = (down.shape[0], down.shape[1])
    bank = _noise(rng, shape, 330.0, 2.2)
    cover = np.clip((bank + 0.9 * (down - 0.55) - 0.45) * 0.9, 0, 1)
    soft = np.clip(_noise(rng, shape, 120.0, 1.6) * 0.12 + 0.86, 0.6, 1.0)
    cloud = soft[:, :, None] * np.array([0.90, 0.92, 0.95])
    amount = (cover * cover * (3 - 2 * cover) * 0.82)[:, :, None]
    return (blue * (1 - amount) + cloud * amount).astype(np.float32)


def _paint_hills(picture: Picture, horizon: float, stand: Stand, rng: np.random.Generator) -> None:
    """Two ridges in the haze and a line of hedges, each darker than the one behind it."""
    ridges = (
        (0.42, 260.0, 0.24, 0.015, np.array([0.33, 0.45, 0.56])),
        (0.28, 150.0, 0.18, 0.03, np.array([0.20, 0.31, 0.27])),
        (0.15, 30.0, 0.10, 0.22, np.array([0.075, 0.13, 0.045])),
    )
    for rise, length, swing, grained, color in ridges:
        line = _noise(rng, (3, stand.width), length)[1] * swing + rise
        top = horizon - np.maximum(line, 0.02) * stand.scale
        row = np.arange(stand.height, dtype=np.float32)[:, None] + 0.5
        share = np.clip(row - top[None] + 0.5, 0, 1) * (row < horizon + 2)
        # Crowns show in the hedge; the ridges are too far away.
        grain = 1 + np.float32(grained) * _noise(rng, (stand.height, stand.width), 9.0)
        picture[:] = picture * (1 - share[:, :, None]) + share[:, :, None] * color * grain[:, :, None]


def _paint_meadow(
    picture: Picture,
    row: Picture,
    column: Picture,
    horizon: float,
    stand: Stand,
    shadow: NDArray[np.float32],
    cell: float,
    rng: np.random.Generator,
) -> None:
    """Grass in perspective, with the tree's shadow."""
    nearness = np.maximum(row - horizon, 0.25) / (
        stand.eye * stand.scale
    )  # distance of the tree / of the point
    away = stand.distance / nearness - stand.distance
    aside = (column - stand.foot[0]) / (stand.scale * nearness)
    half = shadow.shape[0] / 2
    light = cv2.remap(
        shadow,
        (aside / cell + half - 0.5).astype(np.float32),
        (away / cell + half - 0.5).astype(np.float32),
        cv2.INTER_LINEAR,
        borderMode=cv2.BORDER_CONSTANT,
        borderValue=1.0,
    )
    # Noise that is laid on the ground: its coordinates are metres, so it shrinks with the distance.
    ground = np.stack([_noise(rng, (512, 512), size) for size in (128.0, 16.0)])
    patch, tuft = (
        cv2.remap(
            layer,
            (aside * density + 180).astype(np.float32),
            (away * density + 220).astype(np.float32),
            cv2.INTER_LINEAR,
            borderMode=cv2.BORDER_REFLECT_101,  # a repeated picture would meet itself at a visible line
        )
        for layer, density in zip(ground, (9.0, 40.0), strict=True)
    )
    near = np.clip(nearness / 1.6, 0, 1)
    blade = cv2.GaussianBlur(_noise(rng, (row.shape[0], row.shape[1]), 5.0, 0.35), (0, 0), 0.6)
    far = np.exp(-np.maximum(away, 0) / 160.0)[:, :, None]
    grass = np.array([0.145, 0.215, 0.050]) + patch[:, :, None] * np.array([0.020, 0.014, 0.004])
    grass = grass * (1 + (0.13 * tuft * near + 0.16 * blade * near)[:, :, None])
    grass = far * grass + (1 - far) * np.array([0.21, 0.29, 0.13])
    lit = grass * (0.34 * np.array([0.85, 0.95, 1.2]) + 0.66 * light[:, :, None] * np.array([1.04, 1.0, 0.9]))
    share = np.clip(row - horizon, 0, 1)[:, :, None]
    picture[:] = picture * (1 - share) + lit * share
