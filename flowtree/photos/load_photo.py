"""Reads a photograph at the working resolution."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from flowtree.model.photo import Photo
from flowtree.params import PhotoParams
from flowtree.photos.decode_picture import decode_picture


def load_photo(path: str | Path, *, params: PhotoParams = PhotoParams()) -> Photo:
    """Reads a photograph, upright, its larger side at most ``params.working_height`` pixels.

    JPEG, PNG (8 or 16 bit; grey, palette, RGB, with alpha), WebP and TIFF are read; the EXIF orientation is
    applied, and pixels are counted in the header before any is decoded. Scaling is by area, and never up.

    Args:
        path: the file.
        params: the working size and the cap on pixels.

    Returns:
        The photo. Its ``alpha`` is None where the file has no alpha channel or is opaque everywhere, its
        ``focal_length`` where the EXIF part does not say it.

    Raises:
        InputError: no such file, not a picture, truncated, too large, or smaller than 16 x 16 pixels.
    """
    picture = decode_picture(path, side=params.working_height, params=params)
    alpha = None if picture.alpha is None else picture.alpha.astype(np.float32) / np.float32(255.0)
    return Photo(
        name=Path(path).name,
        rgb=picture.rgb,
        alpha=alpha,
        scale=picture.scale,
        focal_length=picture.focal_length,
    )
