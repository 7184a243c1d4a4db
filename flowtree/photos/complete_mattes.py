"""What a photograph's frame cuts off of its tree, as the other views let it be expected."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import cv2
import numpy as np
from numpy.typing import NDArray

from flowtree.model.camera import Camera
from flowtree.model.matte import Matte


def complete_mattes(mattes: Sequence[Matte], cameras: Sequence[Camera]) -> tuple[Matte, ...]:
    """Gives unknown pixels of mattes the alpha that other views show as high and as far from the axis.

    A crown is about as wide and as dense from one side as from the other: a tree seen from one side alone is
    completed by its mirror image for the same reason. The guess is the mean over all other views that know
    that place, and their mirror images. The pixels stay unknown: nobody has to keep to the guess.

    Args:
        mattes: one a view.
        cameras: theirs.

    Returns: the mattes; those that know everything, or of which nothing is known elsewhere, as they are.
    """
    return tuple(
        matte if matte.unknown is None else _complete(k, matte.unknown, mattes, cameras)
        for k, matte in enumerate(mattes)
    )


def _complete(
    view: int, unknown: NDArray[np.bool_], mattes: Sequence[Matte], cameras: Sequence[Camera]
) -> Matte:
    total = np.zeros(unknown.shape, np.float32)
    weight = np.zeros(unknown.shape, np.float32)
    for k, (matte, camera) in enumerate(zip(mattes, cameras, strict=True)):
        if k == view:
            continue
        known = np.ones_like(matte.alpha) if matte.unknown is None else (~matte.unknown).astype(np.float32)
        for side in (1.0, -1.0):
            total += _seen_from(matte.alpha * known, camera, cameras[view], side)
            weight += _seen_from(known, camera, cameras[view], side)
    matte = mattes[view]
    guess = np.divide(total, weight, out=np.zeros_like(total), where=weight > 0.5)
    alpha = np.where(unknown & (weight > 0.5), np.clip(guess, 0.0, 1.0), matte.alpha)
    return replace(matte, alpha=alpha.astype(np.float32))


def _seen_from(
    picture: NDArray[np.float32], camera: Camera, other: Camera, side: float
) -> NDArray[np.float32]:
    """A view's picture, or for ``side`` -1 its mirror image, in the pixels of another view."""
    scale = other.metres_per_pixel / camera.metres_per_pixel
    matrix = np.array(
        [
            [side * scale, 0.0, camera.foot[0] - side * scale * other.foot[0]],
            [0.0, scale, camera.foot[1] - scale * other.foot[1]],
        ]
    )
    matrix[:, 2] += matrix[:, :2] @ np.array([0.5, 0.5]) - 0.5  # OpenCV counts pixel centres from 0
    if scale > 1.3:  # several pixels fall into one
        picture = np.asarray(cv2.GaussianBlur(picture, (0, 0), 0.35 * scale), np.float32)
    flags = cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
    return np.asarray(cv2.warpAffine(picture, matrix, (other.width, other.height), flags=flags), np.float32)
