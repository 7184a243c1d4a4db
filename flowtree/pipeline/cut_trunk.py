"""The photographs once more, as fine as they are, where their trunk is large."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from flowtree.meshing.cut_bark import NARROWEST, cut_bark
from flowtree.meshing.rectify_trunk import HALF_TURN, TrunkPicture
from flowtree.model.camera import Camera
from flowtree.model.matte import Matte
from flowtree.model.mesh import Material
from flowtree.model.photo import Photo
from flowtree.model.placement import Placement
from flowtree.model.skeleton import Skeleton
from flowtree.params import PhotoParams
from flowtree.photos.load_photo import load_photo

_FINEST = 8192  # pixels of a photograph's larger side, at most


def cut_trunk(
    skeleton: Skeleton,
    sources: Sequence[Path | Photo],
    photos: Sequence[Photo],
    placements: Sequence[Placement],
    mattes: Sequence[Matte],
    cameras: Sequence[Camera],
    mirrored: Sequence[bool],
    *,
    scale: float,
    seed: int,
    params: PhotoParams,
) -> Material | None:
    """Bark from the first photograph, the one with the widest trunk first, that shows it well enough.

    A photograph is read once more, at its full size, only where its trunk is wide enough then.

    Args:
        skeleton: with radii [m].
        sources: a file or a photo, one a view, as all that follows.
        photos: as they were read, not yet straightened.
        placements: of the tree in them.
        mattes: of the straightened pictures.
        cameras: of the straightened pictures.
        mirrored: whether a view is its photo's mirror image; those show the same trunk once more.
        scale: length that the texture is to show [m].
        seed: of the quilting.
        params: cap on the size.

    Returns: the bark; None where no photograph shows enough.
    """
    full = params.model_copy(update={"working_height": _FINEST})
    widths = []
    for source, photo, placement, camera in zip(sources, photos, placements, cameras, strict=True):
        warp = np.eye(3) if placement.warp is None else placement.warp
        finer = float(np.sqrt(abs(np.linalg.det(warp[:2, :2])))) / (
            photo.scale if isinstance(source, Path) else 1.0
        )
        widths.append(finer * 2.0 * HALF_TURN * float(skeleton.radius[0]) / camera.metres_per_pixel)
    for view in sorted(range(len(widths)), key=lambda k: -widths[k]):
        source, photo, warped = sources[view], photos[view], placements[view].warp
        if mirrored[view] or widths[view] < NARROWEST:
            continue
        opened = load_photo(source, params=full) if isinstance(source, Path) else source
        stretch = opened.rgb.shape[0] / photo.rgb.shape[0]
        matrix = np.diag([stretch, stretch, 1.0]) @ (np.eye(3) if warped is None else warped)
        picture = TrunkPicture(opened.rgb, matrix)
        bark = cut_bark(skeleton, mattes[view], cameras[view], picture, scale=scale, seed=seed)
        if bark is not None:
            return bark
    return None
