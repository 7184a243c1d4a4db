"""The share of each pixel that a tree covers."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flowtree.model.camera import Camera
from flowtree.model.tree import TreeModel
from flowtree.render.assemble_scene import assemble_scene
from flowtree.render.camera_bands import camera_bands
from flowtree.render.cast_scene import cast_scene


def render_mask(
    tree: TreeModel, camera: Camera, *, samples: int = 4, device: str | None = None
) -> NDArray[np.float32]:
    """Casts ``samples`` x ``samples`` rays through every pixel and counts those that meet wood or leaf.

    A leaf is there where its texture's alpha reaches the material's cut-off.

    Args:
        tree: the tree, world frame [m].
        camera: of the picture.
        samples: rays along each side of a pixel, 1 to 8.
        device: to run on; the best one by default.

    Returns: (camera.height, camera.width) float32 in 0..1.

    Raises:
        InputError: a tree with NaN or wrong indices, a camera without a picture.
    """
    scene = assemble_scene(tree)
    mask = np.empty((camera.height, camera.width), np.float32)
    for rows, view in camera_bands(camera, samples):
        hit = cast_scene(scene, view, any_hit=True, device=device).hit
        mask[rows] = pixel_share(hit, samples)
    return mask


def pixel_share(hit: NDArray[np.int32], samples: int) -> NDArray[np.float32]:
    """Rays (h * samples, w * samples) that met something, as a share of each pixel (h, w)."""
    count = np.zeros((hit.shape[0] // samples, hit.shape[1] // samples), np.uint8)
    met = (hit != 0).view(np.uint8)
    for row in range(samples):
        for column in range(samples):
            count += met[row::samples, column::samples]
    return count.astype(np.float32) / np.float32(samples * samples)
