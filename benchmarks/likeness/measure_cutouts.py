"""How right the mattes of cut-out trees before painted skies are, alone and after two scribbles."""

from __future__ import annotations

from collections.abc import Sequence

from benchmarks.likeness.bench import Bench, Row, mean
from benchmarks.likeness.draw_scribble import BACKGROUND, TREE
from benchmarks.likeness.matte_error import matte_error
from benchmarks.likeness.paint_photo import SKIES, paint_photo
from benchmarks.likeness.scribble_matte import scribble_matte
from benchmarks.likeness.show_mattes import show_mattes
from benchmarks.likeness.show_sheet import show_sheet
from flowtree.pipeline.reconstruct import reconstruct

_AUTOMATIC, _SCRIBBLED = 0.03, 0.02


def measure_cutouts(bench: Bench, names: Sequence[str]) -> list[Row]:
    """Three skies a tree: the mean absolute error of the matte over the tree's box.

    One scribble on the tree and one beside it follow, each where the matte is then most wrong so. The first
    sky's photograph also becomes a tree, for its contact sheet.
    """
    alone, mended = {}, {}
    for name in names:
        for weather, sky in SKIES.items():
            photo, truth = paint_photo(bench.data / "cutouts" / f"{name}.png", sky)
            steps = scribble_matte(photo, truth, [(TREE,), (BACKGROUND,)], bench.params.matting)
            item = f"{name} {weather}"
            alone[item], mended[item] = (matte_error(steps[k][0], truth) for k in (0, -1))
            show_mattes(bench, f"matte_{name}_{weather}", photo, truth, steps)
        if bench.folder is not None:
            first, _ = paint_photo(bench.data / "cutouts" / f"{name}.png", next(iter(SKIES.values())))
            made = reconstruct([first], params=bench.params, cache=bench.cache)
            show_sheet(bench, f"cutout_{name}", made)
    return [
        Row("matte error of cut-outs before skies, automatic", _AUTOMATIC, mean(alone), alone, at_most=True),
        Row("the same, worst", None, max(alone.values()), {}),
        Row("the same, after a scribble on and one beside", _SCRIBBLED, mean(mended), mended, at_most=True),
        Row("the same, worst", None, max(mended.values()), {}),
    ]
