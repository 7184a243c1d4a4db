"""How a matte came about: photograph, true matte, the automatic one, and what each scribble made of it."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from benchmarks.likeness.bench import Bench
from benchmarks.likeness.draw_scribble import BACKGROUND, TREE
from benchmarks.likeness.matte_error import matte_error
from flowtree.model.photo import Photo
from flowtree.render.lay_out_sheet import GAP, lay_out_sheet
from flowtree.render.write_picture import write_picture

_SLOT = 310  # width of a panel [pixels]
_INK = {TREE: (40, 220, 60), BACKGROUND: (235, 40, 40)}

Step = tuple[NDArray[np.float32], NDArray[np.uint8]]


def show_mattes(
    bench: Bench, name: str, photo: Photo, truth: NDArray[np.float32], steps: Sequence[Step]
) -> None:
    """Writes ``NAME.jpg`` into the bench's folder, if it has one.

    Args:
        bench: with the folder.
        name: of the file, without its ending.
        photo: (h, w).
        truth: (h, w) the true matte.
        steps: the mattes (h, w) one after the other, each with the scribbles (h, w) it was made with.
    """
    if bench.folder is None:
        return
    panels = [("photo", _small(photo.rgb)), ("true matte", _small(_grey(truth)))]
    for number, (alpha, scribbles) in enumerate(steps):
        panel = _grey(alpha)
        for kind, ink in _INK.items():
            panel[scribbles == kind] = ink
        label = f"{number} scribbles" if number else "automatic"
        panels.append((f"{label}, error {matte_error(alpha, truth):.3f}", _small(panel)))
    width = GAP + len(panels) * (_SLOT + GAP)
    write_picture(lay_out_sheet([panels], width=width, slot=_SLOT), bench.folder / f"{name}.jpg", quality=85)


def _grey(alpha: NDArray[np.float32]) -> NDArray[np.uint8]:
    return np.repeat(np.rint(255 * alpha).astype(np.uint8)[:, :, None], 3, axis=2)


def _small(picture: NDArray[np.uint8]) -> NDArray[np.uint8]:
    size = _SLOT, round(picture.shape[0] * _SLOT / picture.shape[1])
    return np.asarray(cv2.resize(picture, size, interpolation=cv2.INTER_AREA), np.uint8)
