"""A matte, alone and after each scribble that a person would draw next."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from benchmarks.likeness.draw_scribble import draw_scribble
from flowtree.matting.extract_matte import extract_matte
from flowtree.matting.prepare_photo import prepare_photo
from flowtree.model.photo import Photo
from flowtree.params import MattingParams

Step = tuple[NDArray[np.float32], NDArray[np.uint8]]


def scribble_matte(
    photo: Photo, truth: NDArray[np.float32], strokes: Sequence[tuple[int, ...]], params: MattingParams
) -> list[Step]:
    """Extracts the matte, then again after every stroke, each drawn where it is most wrong so.

    Args:
        photo: with the tree.
        truth: (h, w) alpha as it should be.
        strokes: labels that each may have; one for which nothing is wrong is left out.
        params: of matting.

    Returns: alpha (h, w) and the scribbles (h, w) that it was made with, the first without any.
    """
    prepared = prepare_photo(photo, params=params)
    alpha = extract_matte(photo, prepared=prepared, params=params).alpha
    steps = [(alpha, np.zeros(alpha.shape, np.uint8))]
    for labels in strokes:
        alpha, scribbled = steps[-1]
        scribbles = draw_scribble(alpha, truth, scribbled, labels=labels)
        if scribbles is not None:
            alpha = extract_matte(photo, scribbles=scribbles, prepared=prepared, params=params).alpha
            steps.append((alpha, scribbles))
    return steps
