"""Carries an alpha matte from a small picture over to the full one."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from flowtree.geometry.solve_symmetric import solve_symmetric

_REACH, _SMOOTHNESS = 2, 1e-4  # window [pixels of the small picture] and regularisation of the colour lines


def refine_alpha(
    small: NDArray[np.uint8], alpha: NDArray[np.float32], full: NDArray[np.uint8]
) -> NDArray[np.float32]:
    """Carries alpha from a small picture (h, w) to the full one (H, W), twigs as sharp as there.

    Closed-form matting assumes alpha = a I + b in every small window. The lines (a, b) are fitted on the
    small picture (a guided filter with a colour guide), enlarged, and applied to the full picture: He and
    Sun's fast guided filter, with its subsampling done by area.
    """
    window = (2 * _REACH + 1, 2 * _REACH + 1)

    def mean(values: NDArray[Any]) -> NDArray[Any]:
        blurred: NDArray[Any] = cv2.blur(values, window, borderType=cv2.BORDER_REFLECT)
        return blurred

    guide = small.astype(np.float32) / np.float32(255.0)
    mean_guide, mean_alpha = mean(guide), mean(alpha)
    spread = np.empty((*alpha.shape, 3, 3), np.float32)
    for i in range(3):
        for j in range(i, 3):
            product = mean(guide[..., i] * guide[..., j]) - mean_guide[..., i] * mean_guide[..., j]
            spread[..., i, j] = spread[..., j, i] = product
    shared = mean(guide * alpha[..., None]) - mean_guide * mean_alpha[..., None]
    spread += np.float32(_SMOOTHNESS) * np.eye(3, dtype=np.float32)
    slope = solve_symmetric(spread, shared)
    offset = mean_alpha - (slope * mean_guide).sum(axis=2)
    size = (full.shape[1], full.shape[0])
    lines = cv2.resize(mean(np.dstack([slope, offset])), size, interpolation=cv2.INTER_LINEAR)
    # Channel after channel: the last axis is too short for `sum`, which takes ten times as long.
    red, green, blue = (
        lines[..., k] * (full[..., k].astype(np.float32) / np.float32(255.0)) for k in range(3)
    )
    refined = red + green + blue + lines[..., 3]
    result: NDArray[np.float32] = np.clip(refined, 0.0, 1.0).astype(np.float32)
    return result
