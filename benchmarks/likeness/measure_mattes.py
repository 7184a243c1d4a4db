"""How right the mattes of loose photographs of known trees are, alone and after three scribbles."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from benchmarks.likeness.bench import Bench, Row, load_grey, mean
from benchmarks.likeness.draw_scribble import draw_scribble
from benchmarks.likeness.matte_error import matte_error
from benchmarks.likeness.show_mattes import show_mattes
from flowtree.matting.extract_matte import extract_matte
from flowtree.matting.prepare_photo import prepare_photo
from flowtree.photos.load_photo import load_photo

_AUTOMATIC, _SCRIBBLED = 0.06, 0.04
_STROKES = 3


def measure_mattes(bench: Bench, names: Sequence[str]) -> list[Row]:
    """Two photographs a tree: the mean absolute error of the matte over the tree's box.

    Each of the three scribbles is drawn where the matte is then most wrong (`draw_scribble`).
    """
    alone, mended = {}, {}
    for name in names:
        for number in (0, 1):
            folder = bench.data / "truth" / name
            photo = load_photo(folder / f"photo_{number}.jpg", params=bench.params.photos)
            truth = load_grey(folder / f"alpha_{number}.png")
            prepared = prepare_photo(photo, params=bench.params.matting)
            alpha = extract_matte(photo, prepared=prepared, params=bench.params.matting).alpha
            item = f"{name} {number}"
            alone[item] = matte_error(alpha, truth)
            scribbles = np.zeros(alpha.shape, np.uint8)
            steps = [(alpha, scribbles)]
            for _ in range(_STROKES):
                more = draw_scribble(alpha, truth, scribbles)
                if more is None:
                    break
                scribbles = more
                alpha = extract_matte(
                    photo, scribbles=scribbles, prepared=prepared, params=bench.params.matting
                ).alpha
                steps.append((alpha, scribbles))
            mended[item] = matte_error(alpha, truth)
            show_mattes(bench, f"matte_{name}_{number}", photo, truth, steps)
    return [
        Row("matte error of loose photos, automatic", _AUTOMATIC, mean(alone), alone, at_most=True),
        Row("the same, after three scribbles", _SCRIBBLED, mean(mended), mended, at_most=True),
    ]
