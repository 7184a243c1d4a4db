"""The photographs once more, as fine as they are, where their trunk is large."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from flowtree.meshing.cut_bark import NARROWEST
from flowtree.meshing.rectify_trunk import HALF_TURN, TrunkPicture
from flowtree.model.camera import Camera
from flowtree.model.photo import Photo
from flowtree.model.placement import Placement
from flowtree.model.skeleton import Skeleton
from flowtree.params import PhotoParams
from flowtree.photos.load_photo import load_photo

_FINEST = 8192  # pixels of a photograph's larger side, at most


def open_trunks(
    skeleton: Skeleton,
    sources: Sequence[Path | Photo],
    photos: Sequence[Photo],
    placements: Sequence[Placement],
    cameras: Sequence[Camera],
    mirrored: Sequence[bool],
    *,
    params: PhotoParams,
) -> tuple[TrunkPicture | None, ...]:
    """Each view's picture at full size, None where its trunk is too narrow for bark even so.

    Args:
        skeleton: with radii [m].
        sources: a file or a photo, one a view, as everything that follows.
        photos: as they were read, not yet straightened.
        placements: of the tree in them.
        cameras: of the straightened pictures.
        mirrored: whether a view is its photo's mirror image; those show the same trunk once more.
        params: cap on the size.
    """
    full = params.model_copy(update={"working_height": _FINEST})
    found: list[TrunkPicture | None] = []
    for source, photo, placement, camera, again in zip(
        sources, photos, placements, cameras, mirrored, strict=True
    ):
        warp = np.eye(3) if placement.warp is None else placement.warp
        ratio = float(np.sqrt(abs(np.linalg.det(warp[:2, :2])))) / photo.scale
        width = 2.0 * HALF_TURN * float(skeleton.radius[0]) / camera.metres_per_pixel
        if again or width * (ratio if isinstance(source, Path) else ratio * photo.scale) < NARROWEST:
            found.append(None)
            continue
        opened = load_photo(source, params=full) if isinstance(source, Path) else source
        stretch = opened.rgb.shape[0] / photo.rgb.shape[0]
        found.append(TrunkPicture(opened.rgb, np.diag([stretch, stretch, 1.0]) @ warp))
    return tuple(found)
