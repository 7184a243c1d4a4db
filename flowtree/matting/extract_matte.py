"""From a photograph to its alpha matte."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from flowtree.matting.cut_out_tree import CutOut, cut_out_tree
from flowtree.matting.estimate_foreground import estimate_foreground
from flowtree.matting.prepare_photo import PreparedPhoto
from flowtree.model.matte import Matte
from flowtree.model.photo import Photo
from flowtree.params import MattingParams


def extract_matte(
    photo: Photo,
    *,
    trimap: ArrayLike | None = None,
    scribbles: ArrayLike | None = None,
    prepared: PreparedPhoto | None = None,
    params: MattingParams = MattingParams(),
) -> Matte:
    """Cuts the tree out (`cut_out_tree`) and frees its colours of the background (`color_matte`).

    Args:
        photo: with h x w pixels.
        trimap: (h, w), see `cut_out_tree`.
        scribbles: (h, w), see `cut_out_tree`.
        prepared: of this photo, see `cut_out_tree`.
        params: picked colours, and the size to solve at.

    Raises:
        InputError: see `cut_out_tree`.
    """
    cut = cut_out_tree(photo, trimap=trimap, scribbles=scribbles, prepared=prepared, params=params)
    return color_matte(photo, cut)


def color_matte(photo: Photo, cut: CutOut) -> Matte:
    """The matte with its foreground; what stands before the tree lends it neither alpha nor colour."""
    if cut.occluded is None:
        return Matte(cut.alpha, estimate_foreground(photo.rgb, cut.alpha), cut.method)
    shown = np.where(cut.occluded, np.float32(0.0), cut.alpha)
    return Matte(cut.alpha, estimate_foreground(photo.rgb, shown), cut.method, cut.occluded)
