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
_GREEN = (0.45, 0.62, 0.25)  # stalks among petals, relative to these


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
    canvas.blade((0.0, 0.16), 0.0, 0.84, slender=0.375, base=0.68, tip=1.3, veins=8, teeth=0.11)


def _lanceolate(canvas: LeafCanvas, rng: np.random.Generator) -> None:
    canvas.stroke((0.0, 0.0), 0.0, 0.12, (0.018, 0.015), tint=_STALK)
    canvas.blade((0.0, 0.08), 0.0, 0.92, slender=0.135, base=0.85, tip=1.2, veins=15, teeth=0.09)


def _needle(canvas: LeafCanvas, rng: np.random.Generator) -> None:
    """A shoot of some years with its side shoots, all set with needles: gaps between them, not one blade."""
    _shoot(canvas, rng, (0.0, 0.0), 0.0, 0.90, young=1.0)
    for pair, place in enumerate(np.linspace(0.10, 0.74, 6)):
        for side in (-1.0, 1.0):
            root = (0.0, 0.90 * float(place) + 0.035 * side * (-1.0) ** pair + rng.uniform(-0.01, 0.01))
            length = (0.30 - 0.22 * float(place)) * rng.uniform(0.85, 1.12)
            _shoot(canvas, rng, root, side * rng.uniform(0.50, 0.72), length, young=float(place))


def _shoot(
    canvas: LeafCanvas,
    rng: np.random.Generator,
    root: tuple[float, float],
    lean: float,
    length: float,
    *,
    young: float,
) -> None:
    """A twig with needles on both sides, the last ones short and close to it; ``young`` ends are lighter."""
    way = np.array([np.sin(lean), np.cos(lean)])
    canvas.stroke(root, lean, length, (0.016, 0.007), tint=_TWIG)
    for place in np.sort(rng.uniform(0.04, 1.0, round(130 * length))):
        side = rng.choice((-1.0, 1.0))
        spread = lean + side * rng.uniform(0.6, 1.1) * (1.0 - 0.65 * place**3)
        needle = rng.uniform(0.060, 0.082) * (1.0 - 0.3 * place**2)
        shade, fresh = rng.uniform(0.62, 1.18), 0.25 * young * float(place) ** 3
        tint = (shade * (1.0 + 1.3 * fresh), shade * (1.0 + fresh), shade * (1.08 - fresh))
        x, y = root + length * place * way
        canvas.stroke((float(x), float(y)), spread, needle, (0.0115, 0.007), tint=tint)


def _frond(canvas: LeafCanvas, rng: np.random.Generator) -> None:
    pairs = 27
    for place in np.linspace(0.15, 0.97, pairs):
        for side in (-1.0, 1.0):
            lean = (1.18 - 0.78 * place) * rng.uniform(0.90, 1.10)
            swell = np.sin(np.pi * (0.18 + 0.74 * place)) ** 0.8
            length = 0.31 * swell * rng.uniform(0.88, 1.06)
            length = min(length, (rng.uniform(0.93, 0.995) - 0.88 * place) / max(np.cos(lean), 0.2))
            shade = rng.uniform(0.74, 1.16)
            canvas.blade(
                (0.0, 0.88 * float(place)),
                side * lean,
                length,
                slender=0.044,
                base=0.6,
                tip=0.9,
                veins=0,
                tint=(shade * rng.uniform(0.96, 1.08), shade, shade),
            )
    canvas.stroke((0.0, 0.0), 0.0, 0.89, (0.030, 0.008), tint=(1.15, 1.1, 0.8))


def _compound(canvas: LeafCanvas, rng: np.random.Generator) -> None:
    canvas.stroke((0.0, 0.0), 0.0, 0.72, (0.018, 0.010), tint=_STALK)
    # From the tip down, so that each pair lies over the one above it.
    _leaflet(canvas, rng, (0.0, 0.66), rng.uniform(-0.1, 0.1), 0.34)
    for place, length in zip((0.56, 0.37, 0.19), (0.35, 0.36, 0.30), strict=True):
        for side in (-1.0, 1.0):
            lean = side * rng.uniform(0.84, 1.04)
            root = (0.0, place + rng.uniform(-0.02, 0.02))
            canvas.stroke(root, lean, 0.05, (0.010, 0.008), tint=_STALK)
            begin = (root[0] + 0.03 * float(np.sin(lean)), root[1] + 0.03 * float(np.cos(lean)))
            _leaflet(canvas, rng, begin, lean, length * rng.uniform(0.93, 1.04))


def _leaflet(
    canvas: LeafCanvas, rng: np.random.Generator, root: tuple[float, float], lean: float, length: float
) -> None:
    shade = rng.uniform(0.84, 1.12)
    tint = (shade * rng.uniform(0.92, 1.10), shade, shade * rng.uniform(0.9, 1.05))
    canvas.blade(root, lean, length, slender=0.255, base=0.8, tip=1.15, veins=8, teeth=0.09, tint=tint)


def _blossom(canvas: LeafCanvas, rng: np.random.Generator) -> None:
    """A cluster of flowers on stalks that spring from one place, the largest on top."""
    hearts = [
        (-0.19, 0.47, 0.17),
        (0.21, 0.52, 0.17),
        (-0.11, 0.80, 0.18),
        (0.15, 0.79, 0.165),
        (0.01, 0.60, 0.20),
    ]
    for x, y, _ in hearts:
        way = (x, y - 0.06)
        canvas.stroke(
            (0.0, 0.06), float(np.arctan2(*way)), float(np.hypot(*way)), (0.012, 0.012), tint=_GREEN
        )
    canvas.stroke((0.0, 0.0), 0.0, 0.08, (0.022, 0.018), tint=_TWIG)
    for x, y, reach in hearts:
        _flower(canvas, rng, (x + rng.uniform(-0.012, 0.012), y + rng.uniform(-0.012, 0.012)), reach)


def _flower(canvas: LeafCanvas, rng: np.random.Generator, heart: tuple[float, float], reach: float) -> None:
    turned, pink = rng.uniform(0.0, 2.0 * np.pi), rng.uniform(0.88, 1.0)
    for petal in range(5):
        angle = turned + 2.0 * np.pi * petal / 5 + rng.uniform(-0.09, 0.09)
        shade = rng.uniform(0.90, 1.03)
        tint = (shade, shade * pink, shade * (0.3 + 0.7 * pink))
        length = reach * rng.uniform(0.94, 1.04)
        canvas.blade(heart, angle, length, slender=0.44, base=0.8, tip=0.36, veins=0, fan=9, tint=tint)
    canvas.stroke(heart, 0.0, 0.001, (0.035, 0.035), tint=(0.8, 0.55, 0.45))
    for _ in range(14):
        angle, length = rng.uniform(0.0, 2.0 * np.pi), reach * rng.uniform(0.18, 0.42)
        canvas.stroke(heart, angle, length, (0.005, 0.004), tint=(1.05, 0.85, 0.75))
        end = (heart[0] + length * float(np.sin(angle)), heart[1] + length * float(np.cos(angle)))
        canvas.stroke(end, 0.0, 0.001, (0.014, 0.014), tint=(1.0, 0.72, 0.22))


@dataclass(frozen=True)
class _Habit:
    width: float  # of the canvas, in heights
    paint: Callable[[LeafCanvas, np.random.Generator], None]


_HABITS = {
    "broad": _Habit(0.68, _broad),
    "lanceolate": _Habit(0.28, _lanceolate),
    "needle": _Habit(0.48, _needle),
    "frond": _Habit(0.54, _frond),
    "compound": _Habit(0.72, _compound),
    "blossom": _Habit(0.80, _blossom),
}
LEAF_WIDTHS = {shape: habit.width for shape, habit in _HABITS.items()}
