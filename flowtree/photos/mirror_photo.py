"""The mirror image of a photograph: a loosely similar second view of a tree seen once."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from flowtree.model.photo import Photo


def mirror_photo(photo: Photo) -> Photo:
    """The photo with left and right exchanged; mirroring twice gives the same pixels again.

    A tree photographed once has no second view. Most trees are as wide and as dense from the side as from the
    front, so the mirror image serves as one.
    """
    alpha = None if photo.alpha is None else np.ascontiguousarray(photo.alpha[:, ::-1])
    rgb = np.ascontiguousarray(photo.rgb[:, ::-1])
    return replace(photo, name=f"{photo.name} (mirrored)", rgb=rgb, alpha=alpha)
