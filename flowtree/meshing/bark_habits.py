"""What barks look like: height and relative colour of a tile, for each habit."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from flowtree.meshing.tile_noise import Floats, tile_cells, tile_noise

# (height (s, s) in tile widths, relative linear colour (s, s, 3) around 1)
BarkPattern = Callable[[np.random.Generator, int], tuple[Floats, Floats]]


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
    light = 0.27 + 0.75 * top + 0.09 * fibre * ridge + 0.06 * crumb
    light = (
        light * (1.0 + 0.08 * _of_cells(rng, number, 96) * ridge) * (1.0 + 0.05 * tile_noise(rng, size, 3, 3))
    )
    return height, _tinted(light, 0.10 * (1.0 - top) - 0.03 * tile_noise(rng, size, 4, 4))


def plated(rng: np.random.Generator, size: int) -> tuple[Floats, Floats]:
    """Long plates of many thin layers between deep cracks, as on pine, spruce, larch."""
    x, y = _torus(size)
    warp = 0.6 * tile_noise(rng, size, 4, 3, rough=0.6) + 0.4 * tile_noise(rng, size, 14, 9, rough=1.0)
    x = x + 0.030 * warp
    y = y + 0.026 * tile_noise(rng, size, 7, 6, rough=1.0)
    plate, number = tile_cells(rng, x, y, 6, 3)
    scale, piece = tile_cells(rng, x + 0.012 * tile_noise(rng, size, 18, 14), y, 13, 9)
    # Each plate has flaked off to another depth here and there: terraces of a noise.
    relief = 1.5 * tile_noise(rng, size, 9, 6, rough=0.9) + 1.2 * _of_cells(rng, number, 18)
    relief = relief + 0.5 * _of_cells(rng, piece, 117)
    flake = (np.floor(relief) + _step(0.7, 1.0, relief - np.floor(relief))) / 4.0
    crumb = tile_noise(rng, size, 60, 40, rough=2.0)
    fibre = tile_noise(rng, size, 40, 8, rough=1.2)
    # Cracks gape here and are closed there.
    wide = np.clip(0.15 + 0.08 * tile_noise(rng, size, 5, 5), 0.04, 0.4)
    top = _step(0.0, 1.0, plate / wide) * (0.55 + 0.45 * _step(0.0, 0.10, scale + 0.05 * crumb))
    height = top * (0.018 + 0.008 * flake) + 0.0011 * crumb + 0.0006 * fibre
    light = (0.26 + 0.66 * top) * (1.0 + 0.24 * flake * top) + 0.07 * crumb + 0.05 * fibre * top
    warmth = 0.09 * flake * top + 0.05 * _of_cells(rng, piece, 117) * top - 0.12 * (1.0 - top)
    return height, _tinted(light, warmth)


def smooth(rng: np.random.Generator, size: int) -> tuple[Floats, Floats]:
    """A thin skin with faint wrinkles around the trunk, small lenticels and lichen, as on beech, hornbeam."""
    x, y = _torus(size)
    wrinkle = tile_noise(rng, size, 5, 34, rough=0.9)
    fine = tile_noise(rng, size, 14, 70, rough=1.0)
    crumb = tile_noise(rng, size, 60, 60, rough=2.0)
    swell = tile_noise(rng, size, 4, 5, rough=0.5)
    streak = tile_noise(rng, size, 16, 2, rough=0.8)
    # Lichen: pale soft-edged spots in groups.
    spots = tile_noise(rng, size, 11, 11, rough=1.6) + 0.8 * tile_noise(rng, size, 3, 3)
    lichen = _step(0.9, 1.9, spots + 0.15 * crumb)
    dash = _dashes(rng, x, y, 260, length=(0.003, 0.010), thick=(0.0015, 0.0030))
    fold = np.clip(np.abs(wrinkle) - 1.1, 0.0, 0.8)
    height = 0.0035 * swell - 0.0020 * fold + 0.0005 * fine - 0.0010 * dash + 0.0006 * lichen + 0.0003 * crumb
    light = 1.0 + 0.04 * swell - 0.16 * fold + 0.025 * fine + 0.04 * streak - 0.22 * dash + 0.035 * crumb
    light = light * (1.0 + 0.20 * lichen)
    warmth = 0.010 * streak - 0.03 * lichen + 0.03 * dash + 0.012 * tile_noise(rng, size, 5, 4)
    return height, _tinted(light, warmth)


def papery(rng: np.random.Generator, size: int) -> tuple[Floats, Floats]:
    """White skin that peels in bands around the trunk, dark lenticels and rough scars, as on birch, aspen."""
    x, y = _torus(size)
    band = tile_noise(rng, size, 2, 20, rough=1.2)
    fine = tile_noise(rng, size, 6, 80, rough=1.0)
    crumb = tile_noise(rng, size, 40, 60, rough=2.0)
    y = y + 0.0025 * band
    dash = np.maximum(
        _dashes(rng, x, y, 170, length=(0.006, 0.030), thick=(0.0016, 0.0034)),
        _dashes(rng, x, y, 26, length=(0.030, 0.085), thick=(0.0022, 0.0045)),
    )
    # Rough dark patches, wider than high and of all sizes, so that no one of them betrays the repeat.
    torn = tile_noise(rng, size, 16, 30, rough=2.2)
    patches = tile_noise(rng, size, 7, 13, rough=0.9) + 0.25 * torn
    scar = _step(1.8, 2.2, patches)
    peel = np.clip(band - 1.2, 0.0, 1.0)
    edge = np.clip(np.roll(peel, 2, axis=0) - peel, 0.0, 1.0)
    height = (
        0.0006 * band + 0.0022 * peel - 0.0014 * dash + 0.003 * scar * (0.6 + 0.4 * torn) + 0.0003 * crumb
    )
    light = (1.04 + 0.03 * band + 0.02 * fine + 0.025 * crumb) * (1.0 - 0.66 * dash)
    light = light * (1.0 - 0.74 * scar * (0.8 + 0.2 * np.clip(torn, -1.0, 1.0))) - 0.10 * peel - 0.9 * edge
    return height, _tinted(light, 0.12 * peel + 0.06 * dash + 0.025 * tile_noise(rng, size, 3, 4))


def ringed(rng: np.random.Generator, size: int) -> tuple[Floats, Floats]:
    """The scars of fallen fronds, ring above ring, and fine fibres along the trunk, as on palms."""
    _, y = _torus(size)
    rings = 8
    phase = y * rings + 0.16 * tile_noise(rng, size, 3, 4, rough=0.6) + 0.03 * tile_noise(rng, size, 25, 6)
    ring = np.mod(phase, 1.0)
    fibre = tile_noise(rng, size, 80, 6, rough=1.0)
    crack = np.clip(tile_noise(rng, size, 26, 5, rough=1.2) - 1.25, 0.0, 0.7)
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


def _dashes(
    rng: np.random.Generator,
    x: Floats,
    y: Floats,
    count: int,
    *,
    length: tuple[float, float],
    thick: tuple[float, float],
) -> Floats:
    """Lens-shaped marks across the trunk: 0 beside them, up to 0.9 in them."""
    size = len(x)
    dash = np.zeros_like(x)
    for _ in range(count):
        center = rng.uniform(0, 1, 2)
        half = length[0] + (length[1] - length[0]) * rng.beta(1.2, 3.0)
        high, deep = rng.uniform(*thick), rng.uniform(0.35, 0.9)
        # Only rows and columns near it: marks are small, the picture is not.
        rows, columns = (
            np.arange(int((middle - reach) * size) - 1, int((middle + reach) * size) + 3) % size
            for middle, reach in ((center[1], 2.5 * high + 0.012), (center[0], half))
        )
        rows, columns = (np.unique(index) for index in (rows, columns))
        near = np.ix_(rows, columns)
        away_x, away_y = _around(x[near] - center[0]), _around(y[near] - center[1])
        lens = np.clip(1.0 - (away_x / half) ** 2, 0.0, 1.0) - (away_y / high) ** 2
        dash[near] = np.maximum(dash[near], deep * _step(-0.3, 0.7, lens))
    return dash


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
