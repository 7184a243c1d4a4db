"""What a livewire path pays in every cell: little along visible branches, much outside the tree."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from flowtree.attraction.cut_working_grid import WorkingGrid
from flowtree.attraction.find_ridges import find_ridges
from flowtree.attraction.outline_crown import CrownOutline

_THICKEST = 0.08  # of the height: half width up to which an opaque part can be a limb
_BESIDE_LEADER = 0.04  # of the height: how far from a spire's midline a path pays in full
_LIMB = 0.004  # of the height: half width from which a bare tree's limb is sure
_GROUND = 0.05  # of the height: how high grass and shadows reach

_Map = NDArray[np.float64]


def weigh_structures(
    grid: WorkingGrid,
    crown: CrownOutline,
    rng: np.random.Generator,
    wood: _Map,
    limbs: tuple[_Map, _Map] | None = None,
) -> _Map:
    """Cost per cell (h, w) of a path, > 0 and finite.

    Four readings are combined: ridges of the matte (twigs before the sky), ridges of the picture's lightness
    in both directions (dark limbs between leaves, the white stem of a birch), the stem's own colour where it
    differs from the leaves', and the depth inside the crown, which alone is left where the picture shows
    nothing.

    Args:
        grid: the working picture.
        crown: its filled shape.
        rng: draws a weak smooth disturbance, so that a path through a uniform crown is no straight wire.
        wood: (h, w) as `stem_likeness` gives it.
        limbs: of a bare tree, as `measure_limbs` gives them: there the middle of a limb is all that counts.
    """
    middle, thickness = _middle_of_limbs(grid, _thickest(grid, crown))
    limb_like = (thickness > 2.5) & (thickness < _thickest(grid, crown))
    # A ridge filter also answers along the inner edges of a thick stem: there only its middle counts.
    ridge = _ridges(grid.alpha, grid.tall) * np.where(thickness > 2.5, middle**1.5, 1.0)
    limb = middle**2 * limb_like * np.clip(2.0 * wood, 0.0, 1.0)
    picture = _picture_ridges(grid) * (0.2 + 0.8 * wood)
    ridge = np.maximum(np.maximum(ridge, picture), 0.9 * limb)
    evidence = np.clip(ridge * (0.5 + 0.5 * wood) + 0.35 * np.maximum(0.0, 2.0 * wood - 1.0), 0.0, 1.0)
    evidence *= np.clip(grid.alpha * 1.5, 0.0, 1.0)
    # Bark has ridges of its own: inside a limb a path keeps to the middle.
    evidence *= np.where(limb_like, 0.35 + 0.65 * middle, 1.0)
    if limbs is not None:
        clear, half = limbs
        evidence = np.maximum(0.5 * evidence, clear**2 * np.clip(half / _LIMB, 0.0, 1.0))
    # Deep inside the crown a path is free; along its edge it pays up to three times as much.
    depth = np.minimum(crown.depth, 0.12) / 0.12
    inside = 1.0 + 2.0 * (1.0 - depth) ** 2
    empty = 1.0 + 2.5 * (1.0 - np.clip(2.0 * ndimage.gaussian_filter(grid.alpha, 0.6), 0.0, 1.0))
    outside = np.where(crown.shape, 1.0, 8.0)
    # Just above the ground only the stem is sure to be tree: the rest may be grass or a shadow.
    rows = np.arange(grid.alpha.shape[0])[:, None]
    outside = outside * np.where(rows > crown.foot - _GROUND * grid.tall, 3.0, 1.0)
    outside = outside * _leader(grid, crown)
    cost = inside * empty * outside * _disturbance(grid.alpha.shape, grid.tall, rng)
    return np.asarray(cost * (1.0 - evidence) ** 2 + 0.12, np.float64)


def _leader(grid: WorkingGrid, crown: CrownOutline) -> _Map:
    """A factor (h, w) that is 1 on the midline of a spire and higher beside it; 1 in a round crown."""
    columns = np.indices(crown.shape.shape, dtype=np.float64)[1]
    width = crown.shape.sum(axis=1).astype(np.float64)
    # Rows beyond the crown take the nearest midline; the blur is weighted by the rows' width.
    sigma = 0.06 * grid.tall
    weight = ndimage.gaussian_filter1d(width, sigma, mode="nearest")
    middle = ndimage.gaussian_filter1d((columns * crown.shape).sum(axis=1), sigma, mode="nearest")
    middle = middle / np.maximum(weight, 1e-9)
    off = np.clip(np.abs(columns - middle[:, None]) / (_BESIDE_LEADER * grid.tall), 0.0, 1.0)
    # A bare tree shows where its leader is.
    solid = float(grid.alpha[crown.shape].mean()) if crown.shape.any() else 0.0
    trust = crown.narrowness * float(np.clip((solid - 0.4) / 0.3, 0.0, 1.0))
    return np.asarray(1.0 + 2.0 * trust * off)


def _thickest(grid: WorkingGrid, crown: CrownOutline) -> float:
    """Half width [cells] up to which an opaque part can be a limb: the stem's, where one shows."""
    share = 1.25 * crown.stem / grid.tall
    return grid.tall * (max(_THICKEST, share) if share < 2.0 * _THICKEST else _THICKEST)


def _middle_of_limbs(grid: WorkingGrid, thickest: float) -> tuple[_Map, _Map]:
    """How near the middle of its limb a cell lies, 0 at the edge to 1, and the limb's half width [cells].

    The half width is the radius of the largest disc inside the opaque matte that covers the cell.
    """
    depth = ndimage.distance_transform_edt(np.pad(grid.alpha > 0.5, 1))[1:-1, 1:-1]
    half = np.array(depth, np.float64)
    radius = 2.0
    while radius <= min(float(depth.max()), 1.3 * thickest):
        half[ndimage.distance_transform_edt(depth < radius) < radius] = radius
        radius *= 1.3
    half = np.maximum(half, depth)
    return np.where(half > 0.0, depth / np.maximum(half, 1e-9), 0.0), half


def _ridges(values: NDArray[np.float32], tall: float) -> _Map:
    """Bright ridges at three scales, 0..1; an ideal ridge of contrast 1 gives about 1."""
    bright, _ = find_ridges(values, [0.004 * tall, 0.009 * tall, 0.018 * tall])
    return np.clip(bright.astype(np.float64) / 0.25, 0.0, 1.0)


def _picture_ridges(grid: WorkingGrid) -> _Map:
    """Ridges of lightness against its surroundings inside the matte, dark and bright alike, 0..1."""
    sigma = 0.05 * grid.tall
    weight = ndimage.gaussian_filter(grid.alpha, sigma) + 1e-3
    light = grid.lab[..., 0]
    around = ndimage.gaussian_filter(light * grid.alpha, sigma) / weight
    # Outside the tree the difference is nothing: the matte's edge is no ridge of the picture.
    difference = (light - around) * grid.alpha
    spread = float(np.sqrt((difference**2).sum() / max(1.0, float(grid.alpha.sum())))) + 2.0
    difference = difference / spread
    bright, dark = find_ridges(difference, [0.008 * grid.tall, 0.016 * grid.tall])
    return np.clip(np.maximum(bright, dark).astype(np.float64) / 0.8, 0.0, 1.0)


def _disturbance(shape: tuple[int, ...], tall: float, rng: np.random.Generator) -> _Map:
    """A smooth random factor around 1 (h, w), with waves of a few hundredths of the height."""
    noise = np.zeros(shape)
    for sigma in (0.015 * tall, 0.04 * tall):
        wave = ndimage.gaussian_filter(rng.standard_normal(shape), sigma, mode="wrap")
        noise += wave / (wave.std() + 1e-12)
    return np.asarray(np.exp(0.16 * noise), np.float64)
