"""What barks look like: height and relative colour of a tile, for each habit."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from flowtree.meshing.tile_noise import Floats, tile_cells, tile_noise

# (height (s, s) in tile widths, relative linear colour (s, s, 3) around 1)
Habit = Callable[[np.random.Generator, int], tuple[Floats, Floats]]


def furrowed(rng: np.random.Generator, size: int) -> tuple[Floats, Floats]:
    """Long ridges that part and meet again, as on oak, ash, maple, poplar."""
    x, y = _torus(size)
    # Where a stretched noise changes its sign there are long lines that meet and part: the furrows.
    furrow = np.minimum(
        np.abs(tile_noise(rng, size, 8, 1.6, rough=0.5)),
        0.25 + np.abs(tile_noise(rng, size, 10, 3.0, rough=0.5)),
    )
    crack, number = tile_cells(rng, x + 0.008 * tile_noise(rng, size, 12, 12), y, 12, 8)
    fibre = tile_noise(rng, size, 60, 9, rough=1.5)
    crumb = tile_noise(rng, size, 45, 35, rough=2.0)
    ridge = _step(0.03, 0.75, furrow + 0.07 * fibre)
    top = ridge * (0.72 + 0.28 * _step(0.0, 0.2, crack))
    height = 0.024 * top + 0.0014 * fibre * ridge + 0.0011 * crumb
    light = 0.34 + 0.68 * top + 0.08 * fibre * ridge + 0.06 * crumb
    light = (
        light * (1.0 + 0.08 * _of_cells(rng, number, 96) * ridge) * (1.0 + 0.05 * tile_noise(rng, size, 3, 3))
    )
    return height, _tinted(light, 0.10 * (1.0 - top) - 0.03 * tile_noise(rng, size, 4, 4))


def plated(rng: np.random.Generator, size: int) -> tuple[Floats, Floats]:
    """Broad plates of many thin layers between deep cracks, as on pine, spruce, larch."""
    x, y = _torus(size)
    x = x + 0.022 * tile_noise(rng, size, 6, 5, rough=0.8)
    y = y + 0.022 * tile_noise(rng, size, 6, 5, rough=0.8)
    plate, number = tile_cells(rng, x, y, 7, 4)
    # Each plate has flaked off to another depth here and there: terraces of a noise.
    relief = 1.6 * tile_noise(rng, size, 9, 7, rough=0.8) + 1.5 * _of_cells(rng, number, 28)
    flake = (np.floor(relief) + _step(0.75, 1.0, relief - np.floor(relief))) / 4.0
    crumb = tile_noise(rng, size, 55, 45, rough=2.0)
    top = _step(0.02, 0.22, plate)
    height = top * (0.016 + 0.009 * flake) + 0.0011 * crumb
    light = (0.32 + 0.66 * top) * (1.0 + 0.26 * flake * top) + 0.07 * crumb
    return height, _tinted(light, 0.03 * flake * top + 0.05 * _of_cells(rng, number, 28) - 0.05 * (1.0 - top))


def smooth(rng: np.random.Generator, size: int) -> tuple[Floats, Floats]:
    """A thin skin with lenticels, peeling in bands around the trunk, as on birch, cherry, beech."""
    x, y = _torus(size)
    band = tile_noise(rng, size, 2, 22, rough=1.2)
    crumb = tile_noise(rng, size, 40, 60, rough=2.0)
    dash = np.zeros((size, size))
    for _ in range(150):
        center, length, thick = (
            rng.uniform(0, 1, 2),
            0.008 + 0.05 * rng.beta(1.2, 4),
            rng.uniform(0.0022, 0.0045),
        )
        away_x, away_y = _around(x - center[0]), _around(y - center[1] + 0.002 * band)
        lens = np.clip(1.0 - (away_x / length) ** 2, 0.0, 1.0) - (away_y / thick) ** 2
        dash = np.maximum(dash, rng.uniform(0.35, 0.9) * _step(-0.3, 0.7, lens))
    # Scars of lost branches: a few dark rough patches, wider than high.
    scar = np.zeros((size, size))
    torn = tile_noise(rng, size, 14, 22, rough=2.5)
    for _ in range(2):
        center, reach = rng.uniform(0, 1, 2), rng.uniform(0.02, 0.045)
        away = np.hypot(_around(x - center[0]) / (1.9 * reach), _around(y - center[1]) / reach)
        scar = np.maximum(scar, _step(0.0, 0.35, 1.0 - away + 0.16 * torn))
    peel = np.clip(band - 1.3, 0.0, 1.0)
    height = 0.0012 * band - 0.003 * dash + 0.005 * scar * (0.6 + 0.4 * torn) + 0.0005 * crumb
    light = (1.05 + 0.035 * band + 0.03 * crumb) * (1.0 - 0.62 * dash) * (1.0 - 0.6 * scar) - 0.12 * peel
    return height, _tinted(light, 0.10 * peel + 0.04 * dash + 0.02 * tile_noise(rng, size, 3, 4))


def ringed(rng: np.random.Generator, size: int) -> tuple[Floats, Floats]:
    """The scars of fallen fronds, ring above ring, and fine fibres along the trunk, as on palms."""
    _, y = _torus(size)
    rings = 8
    phase = y * rings + 0.16 * tile_noise(rng, size, 3, 4, rough=0.6) + 0.03 * tile_noise(rng, size, 25, 6)
    ring = np.mod(phase, 1.0)
    fibre = tile_noise(rng, size, 80, 6, rough=1.0)
    crack = np.clip(tile_noise(rng, size, 26, 5, rough=1.2) - 1.25, 0.0, 1.0)
    crumb = tile_noise(rng, size, 45, 45, rough=2.0)
    groove = 1.0 - _step(0.0, 0.10, ring) * _step(0.0, 0.05, 1.0 - ring)
    lip = np.exp(-(((ring - 0.16) / 0.09) ** 2))
    height = 0.007 * lip - 0.009 * groove - 0.004 * crack + 0.0011 * fibre + 0.0009 * crumb
    light = 0.98 + 0.14 * lip - 0.48 * groove - 0.4 * crack + 0.07 * fibre + 0.06 * crumb
    light = light * (1.0 + 0.1 * np.sin(2.0 * np.pi * (np.floor(phase) % rings) * 0.618))
    return height, _tinted(light, 0.05 * groove + 0.03 * tile_noise(rng, size, 4, 3))


def _torus(size: int) -> tuple[Floats, Floats]:
    center = (np.arange(size) + 0.5) / size
    x, y = np.meshgrid(center, center)
    return x, y


def _around(away: Floats) -> Floats:
    """The shortest way on the torus, -0.5..0.5."""
    short: Floats = away - np.rint(away)
    return short


def _step(low: float, high: float, value: Floats) -> Floats:
    """Hermite's smooth step from 0 at ``low`` to 1 at ``high``."""
    t = np.clip((value - low) / (high - low), 0.0, 1.0)
    step: Floats = t * t * (3.0 - 2.0 * t)
    return step


def _of_cells(rng: np.random.Generator, number: np.ndarray, count: int) -> Floats:
    """One random number of variance 1 for each cell."""
    of_cell: Floats = rng.standard_normal(count)[number]
    return of_cell


def _tinted(light: Floats, warmth: Floats) -> Floats:
    """Relative colour (s, s, 3) of a brightness; warm is more red and less blue."""
    bright = np.clip(light, 0.06, None)[:, :, None]
    tint: Floats = bright * (1.0 + warmth[:, :, None] * np.array([1.0, 0.1, -1.1]))
    return np.clip(tint, 0.02, None)
