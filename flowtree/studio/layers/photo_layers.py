"""Photos and their mattes as pictures."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from flowtree.params import PhotoParams
from flowtree.photos.decode_picture import decode_picture
from flowtree.render.write_picture import encode_picture
from flowtree.studio.layers.layer import JPEG, PNG, Layer

_SIDE = 1600  # pixels of the shown photo's larger side
_QUALITY = 85
_QUICK = 1  # effort of packing: a matte is sent after every scribble


def photo_layer(number: int, file: Path, params: PhotoParams) -> Layer:
    """The upright photo, small enough to travel; what its alpha hides lies on white.

    Raises:
        InputError: the file is no picture that can be read.
    """
    picture = decode_picture(file, side=_SIDE, params=params)
    shown = picture.rgb if picture.alpha is None else np.dstack([picture.rgb, picture.alpha])
    return Layer(f"photo/{number}", JPEG, encode_picture(shown, "JPEG", quality=_QUALITY))


def matte_layer(number: int, alpha: NDArray[np.float32], before: NDArray[np.float32] | None = None) -> Layer:
    """A matte as a grey picture.

    Args:
        number: of the photo.
        alpha: (h, w).
        before: the matte that was sent before; where it has the same size, the box that changed goes apart.
    """
    grey = _grey(alpha)
    data = encode_picture(grey, "PNG", effort=_QUICK)
    if before is None or before.shape != alpha.shape:
        return Layer(f"matte/{number}", PNG, data)
    changed = grey != _grey(before)
    rows, columns = np.flatnonzero(changed.any(axis=1)), np.flatnonzero(changed.any(axis=0))
    if not len(rows):
        rows = columns = np.zeros(1, np.intp)
    left, top, right, bottom = int(columns[0]), int(rows[0]), int(columns[-1]) + 1, int(rows[-1]) + 1
    part = encode_picture(grey[top:bottom, left:right], "PNG", effort=_QUICK)
    return Layer(f"matte/{number}", PNG, data, (left, top, right, bottom), part)


def straight_layer(number: int, rgb: NDArray[np.uint8]) -> Layer:
    """A view's level, parallel picture (h, w, 3)."""
    return Layer(f"straight/{number}", JPEG, encode_picture(rgb, "JPEG", quality=_QUALITY))


def cost_layer(number: int, cost: NDArray[np.uint8]) -> Layer:
    """What a livewire pays, (h, w): 0 cheap, 255 dear."""
    return Layer(f"cost/{number}", PNG, encode_picture(cost, "PNG"))


def _grey(alpha: NDArray[np.float32]) -> NDArray[np.uint8]:
    grey: NDArray[np.uint8] = np.rint(alpha * 255.0).astype(np.uint8)
    return grey
