"""Small pictures of trees, drawn: what tests of whole pipelines start from."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import Image


def draw_tree(seed: int = 0, *, size: tuple[int, int] = (160, 200)) -> NDArray[np.uint8]:
    """A trunk that forks four times, with round bunches of leaves: (h, w, 4) uint8 with an exact alpha."""
    width, height = size
    rng = np.random.default_rng(seed)
    fine = 4
    alpha = np.zeros((height * fine, width * fine), np.uint8)
    color = np.zeros((height * fine, width * fine, 3), np.uint8)

    def grow(x: float, y: float, turn: float, length: float, thick: float, order: int) -> None:
        end = x + length * np.sin(turn), y - length * np.cos(turn)
        start, tip = ((round(a * fine), round(b * fine)) for a, b in ((x, y), end))
        for picture, value in ((alpha, 255), (color, (96, 74, 52))):
            cv2.line(picture, start, tip, value, max(1, round(thick * fine)))
        if order == 4:
            for picture, value in ((alpha, 255), (color, (60, int(rng.integers(90, 150)), 40))):
                cv2.circle(picture, tip, round(0.05 * height * fine), value, -1)
            return
        for side in (-1, 1):
            grow(
                *end,
                turn + side * rng.uniform(0.3, 0.6),
                length * rng.uniform(0.66, 0.8),
                thick * 0.65,
                order + 1,
            )

    grow(width / 2, height - 6, rng.uniform(-0.05, 0.05), 0.24 * height, 0.05 * height, 0)
    shrunk = (width, height)
    covered = cv2.resize(alpha, shrunk, interpolation=cv2.INTER_AREA)
    colors = cv2.resize(color, shrunk, interpolation=cv2.INTER_AREA).astype(np.float64)
    colors /= np.maximum(covered[..., None] / 255.0, 1e-3)
    return np.dstack([np.clip(colors, 0, 255).astype(np.uint8), covered])


def save_pair(folder: Path) -> tuple[Path, Path]:
    """Two pictures with alpha channels, of two trees of one kind."""
    files = (folder / "front.png", folder / "side.png")
    for seed, file in enumerate(files):
        Image.fromarray(draw_tree(seed)).save(file)
    return files
