"""Paints the texture of a leaf."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flowtree.foliage.leaf_canvas import Floats, LeafCanvas

# Twigs, relative to the leaf that the colour is meant for: times green this is brown.
_TWIG = (0.95, 0.52, 0.8)
_STALK = (1.08, 0.95, 0.85)


def paint_leaf(shape: str, *, mean: Floats, cutoff: float, seed: int, size: int) -> NDArray[np.uint8]:
    """Paints veins, edges and variation of one shape (a key of `LEAF_WIDTHS`).

    Unlike the paper, which cuts its textures out of photographs of leaves, they are painted.

    Args:
        shape: which.
        mean: (3,) linear, of the texels that pass the alpha test.
        cutoff: of the alpha test, 0..1.
        seed: another seed, other variation.
        size: height [pixels]; the width follows the shape.

    Returns: (size, w, 4) uint8 sRGB with alpha; the stalk's end is at the bottom's centre.
    """
    rng = np.random.default_rng(seed)
    habit = _HABITS[shape]
    canvas = LeafCanvas(rng, habit.width, size)
    habit.paint(canvas, rng)
    return canvas.finish(mean, cutoff)


def _broad(canvas: LeafCanvas, rng: np.random.Generator) -> None:
    canvas.stroke((0.0, 0.0), 0.0, 0.2, (0.026, 0.018), tint=_STALK)
    canvas.blade((0.0, 0.13), 0.0, 0.86, slender=0.36, widest=0.40, veins=8, teeth=0.07)


def _lanceolate(canvas: LeafCanvas, rng: np.random.Generator) -> None:
    canvas.stroke((0.0, 0.0), 0.0, 0.12, (0.016, 0.014), tint=_STALK)
    canvas.blade((0.0, 0.07), 0.0, 0.92, slender=0.135, widest=0.40, veins=16, teeth=0.05)


def _needle(canvas: LeafCanvas, rng: np.random.Generator) -> None:
    canvas.stroke((0.0, 0.0), 0.0, 0.84, (0.022, 0.010), tint=_TWIG)
    for place in np.sort(rng.uniform(0.03, 0.97, 170)):
        side = rng.choice((-1.0, 1.0))
        # Needles at the end of the year's shoot are shorter and lie closer to it.
        lean = rng.uniform(0.55, 1.05) * (1.0 - 0.55 * place)
        length = rng.uniform(0.20, 0.29) * (1.0 - 0.35 * place)
        length = min(length, (rng.uniform(0.86, 0.99) - 0.86 * place) / max(np.cos(lean), 0.2))
        shade = rng.uniform(0.75, 1.15)
        start = (0.0, 0.84 * float(place))
        canvas.stroke(start, side * lean, length, (0.017, 0.009), tint=(shade, shade, shade * 1.05))


def _frond(canvas: LeafCanvas, rng: np.random.Generator) -> None:
    pairs = 30
    for place in np.linspace(0.16, 0.97, pairs):
        for side in (-1.0, 1.0):
            lean = (1.15 - 0.75 * place) * rng.uniform(0.93, 1.07)
            swell = np.sin(np.pi * (0.18 + 0.74 * place)) ** 0.8
            length = 0.30 * swell * rng.uniform(0.92, 1.05)
            length = min(length, (rng.uniform(0.93, 0.995) - 0.88 * place) / max(np.cos(lean), 0.2))
            shade = rng.uniform(0.85, 1.12)
            canvas.blade(
                (0.0, 0.88 * float(place)),
                side * lean,
                length,
                slender=0.052,
                widest=0.4,
                veins=0,
                tint=(shade, shade, shade),
            )
    canvas.stroke((0.0, 0.0), 0.0, 0.89, (0.030, 0.008), tint=(1.15, 1.1, 0.8))


def _compound(canvas: LeafCanvas, rng: np.random.Generator) -> None:
    canvas.stroke((0.0, 0.0), 0.0, 0.74, (0.018, 0.010), tint=_TWIG)
    places = np.linspace(0.10, 0.64, 7)
    for number, place in enumerate(places):
        side = 1.0 if number % 2 else -1.0
        lean = side * rng.uniform(0.75, 1.05)
        length = rng.uniform(0.32, 0.38)
        root = (0.0, float(place))
        canvas.stroke(root, lean, 0.07, (0.010, 0.008), tint=_STALK)
        shade = rng.uniform(0.85, 1.12)
        tint = (shade * rng.uniform(0.94, 1.06), shade, shade)
        root = (root[0] + 0.05 * float(np.sin(lean)), root[1] + 0.05 * float(np.cos(lean)))
        canvas.blade(root, lean, length, slender=0.30, widest=0.42, veins=7, teeth=0.08, tint=tint)
    canvas.blade((0.0, 0.66), rng.uniform(-0.1, 0.1), 0.33, slender=0.30, widest=0.42, veins=7, teeth=0.08)


def _blossom(canvas: LeafCanvas, rng: np.random.Generator) -> None:
    canvas.stroke((0.0, 0.0), 0.0, 0.5, (0.020, 0.020), tint=(0.75, 0.85, 0.55))
    heart = (0.0, 0.56)
    for petal in range(5):
        angle = 2.0 * np.pi * petal / 5 + rng.uniform(-0.08, 0.08)
        shade = rng.uniform(0.94, 1.06)
        canvas.blade(
            heart,
            angle,
            rng.uniform(0.40, 0.43),
            slender=0.40,
            widest=0.66,
            veins=0,
            tint=(shade, shade, shade),
        )
    for _ in range(22):
        angle, length = rng.uniform(0.0, 2.0 * np.pi), rng.uniform(0.06, 0.15)
        canvas.stroke(heart, angle, length, (0.006, 0.006), tint=(1.05, 0.9, 0.6))
        tip = (heart[0] + length * float(np.sin(angle)), heart[1] + length * float(np.cos(angle)))
        canvas.stroke(tip, 0.0, 0.002, (0.022, 0.022), tint=(1.05, 0.8, 0.3))


@dataclass(frozen=True)
class _Habit:
    width: float  # of the canvas, in heights
    paint: Callable[[LeafCanvas, np.random.Generator], None]


_HABITS = {
    "broad": _Habit(0.68, _broad),
    "lanceolate": _Habit(0.28, _lanceolate),
    "needle": _Habit(0.52, _needle),
    "frond": _Habit(0.54, _frond),
    "compound": _Habit(0.72, _compound),
    "blossom": _Habit(0.88, _blossom),
}
LEAF_WIDTHS = {shape: habit.width for shape, habit in _HABITS.items()}
