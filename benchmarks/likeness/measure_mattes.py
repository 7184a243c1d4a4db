"""How right the mattes of loose photographs of known trees are, alone and after three scribbles."""

from __future__ import annotations

from collections.abc import Sequence

from benchmarks.likeness.bench import Bench, Row, load_grey, mean
from benchmarks.likeness.draw_scribble import BACKGROUND, TREE
from benchmarks.likeness.matte_error import matte_error
from benchmarks.likeness.scribble_matte import scribble_matte
from benchmarks.likeness.show_mattes import show_mattes
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
            steps = scribble_matte(photo, truth, _STROKES * [(TREE, BACKGROUND)], bench.params.matting)
            item = f"{name} {number}"
            alone[item], mended[item] = (matte_error(steps[k][0], truth) for k in (0, -1))
            show_mattes(bench, f"matte_{name}_{number}", photo, truth, steps)
    return [
        Row("matte error of loose photos, automatic", _AUTOMATIC, mean(alone), alone, at_most=True),
        Row("the same, after three scribbles", _SCRIBBLED, mean(mended), mended, at_most=True),
    ]
