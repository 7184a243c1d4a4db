"""A view as a canvas: how much of every pixel is covered, and what each cell should show on the whole."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy.sparse as sparse
from numpy.typing import NDArray

from flowtree.geometry.footprint_means import OPAQUE, footprint_means
from flowtree.geometry.parent_array import main_child
from flowtree.geometry.plane_grid import PlaneGrid, cover_picture
from flowtree.geometry.projection import View, foreshorten, growth, view_axes

FINE = 4  #: pixels of a canvas along a cell's side: about what a leaf is wide
RING = 0.83  #: mean width of a twig's surface, rings of three corners, to that of a round twig
_CORNERS = 12  # of the thickest ring; thinner ones have fewer, by the root of three of their radius
CELLS = 64  #: along a tree's height, from its foot: those of `soft_iou`; across them a choice is worth less
_GUESSED = np.float32(0.5)  # what an unknown pixel counts less: its alpha is a guess from around
_LIMB = 4  # points to a pixel, along and across limbs
_MARGIN = 1  # cells around the picture, where nothing should be

_Floats = NDArray[np.floating[Any]]


@dataclass(frozen=True)
class CoverCanvas:
    """Pixels in a view's plane, `FINE` by `FINE` in each cell of a grid.

    Things on a canvas are rows of a sparse matrix (things, pixels + 1): the share of each pixel that a thing
    covers. The last column takes what lies beside the canvas.

    Attributes:
        grid: the cells.
        wanted: (columns, rows) alpha that each cell should show.
        known: (columns, rows) in 0..1, how surely each cell's alpha is known.
        depth: (pixels + 1,) float32, optical depth of what stands there anyway.
    """

    grid: PlaneGrid
    wanted: NDArray[np.float32]
    known: NDArray[np.float32]
    depth: NDArray[np.float32]

    def flat(self, points: _Floats) -> NDArray[np.float32]:
        """World points (n, 3) [m] as (n, 2) [pixels], image-right and up from the canvas' corner."""
        seen = self.turn(foreshorten(points, self.grid))
        return seen - np.array([self.grid.left, self.grid.bottom], np.float32) / self._pixel

    def turn(self, vectors: _Floats) -> NDArray[np.float32]:
        """World vectors (n, 3) [m] at the plane through the axis as (n, 2) [pixels]."""
        right, _, _ = view_axes(self.grid.yaw)
        flat = np.empty((len(vectors), 2), np.float32)
        np.multiply(vectors[:, 0], right[0] / self._pixel, out=flat[:, 0], casting="same_kind")
        flat[:, 0] += vectors[:, 2] * (right[2] / self._pixel)
        np.divide(vectors[:, 1], self._pixel, out=flat[:, 1], casting="same_kind")
        return flat

    @property
    def _pixel(self) -> np.float32:
        return np.float32(self.grid.cell / FINE)

    def index(self, x: NDArray[np.float32], y: NDArray[np.float32]) -> NDArray[np.int32]:
        """Pixels' indices of places [pixels], one of every cell after the other; the last for all beside."""
        i, j = np.floor(x).astype(np.int32), np.floor(y).astype(np.int32)
        inside = (i >= 0) & (i < self.grid.columns * FINE) & (j >= 0) & (j < self.grid.rows * FINE)
        cell = i // FINE * np.int32(self.grid.rows) + j // FINE
        pixel = (i % FINE * FINE + j % FINE) * np.int32(self.wanted.size) + cell
        return np.where(inside, pixel, np.int32(len(self.depth) - 1))

    def cell_index(self, pixels: NDArray[np.int32]) -> NDArray[np.int32]:
        """The cell of each pixel's index; one more than there are for what lies beside the canvas."""
        cells = np.int32(self.wanted.size)
        return np.where(pixels == len(self.depth) - 1, cells, pixels % cells).astype(np.int32)

    def cell_means(self, picture: NDArray[np.float32]) -> NDArray[np.float32]:
        """Means (columns, rows) over the pixels (pixels + 1,) of each cell."""
        means = picture[:-1].reshape(FINE * FINE, -1).sum(axis=0) * np.float32(1.0 / FINE**2)
        return np.asarray(means.reshape(self.wanted.shape), np.float32)

    def spread(self, cells: NDArray[np.float32]) -> NDArray[np.float32]:
        """Each cell's value in all its pixels (pixels + 1,); 0 beside the canvas."""
        wide = np.zeros(len(self.depth), np.float32)
        wide[:-1].reshape(FINE * FINE, -1)[:] = cells.reshape(1, -1)
        return wide

    def shown(self) -> NDArray[np.float32]:
        """Alpha (columns, rows) of what stands there anyway."""
        return np.asarray(-self.cell_means(np.expm1(-self.depth)), np.float32)

    def missing(self) -> NDArray[np.float32]:
        """Alpha (columns, rows) that is wanted and not shown; below 0 where too much is shown."""
        return np.asarray((self.wanted - self.shown()) * self.known, np.float32)

    def with_tree(self, parent: NDArray[np.integer[Any]], points: _Floats, radius: _Floats) -> CoverCanvas:
        """The canvas on which a tree of rods stands, too, one from every node's parent to the node.

        Args:
            parent: (n,), -1 at roots.
            points: (n, 3) [m].
            radius: (n,) at the nodes [m].
        """
        nodes = np.flatnonzero(parent >= 0)
        above = parent[nodes]
        place, width = points.astype(np.float64), radius.astype(np.float64)
        wide = rod_radii(parent, width)[nodes]
        rods = (place[above], place[nodes], wide)
        thick = 2 * wide > self._pixel
        # Points a pixel apart leave some pixels out and fall into others twice: a limb must have no holes.
        _, pixels, share = self._sample_rods(*(part[thick] for part in rods), fine=_LIMB)
        cover = np.bincount(pixels, share, minlength=len(self.depth))  # side by side within a pixel
        depth = self.depth - np.log1p(-np.minimum(cover, OPAQUE))
        # Thin branches cross each other at random, and what one covers of a pixel is its width.
        entries, pixels, share = self._sample_rods(*(part[~thick] for part in rods))
        middle = (rods[0] + rods[1])[~thick] / 2
        width = np.minimum(2 * wide[~thick] * growth(middle, self.grid) / self._pixel, OPAQUE)
        deepen = -np.log1p(-width) / np.maximum(width, 1e-12)
        depth += np.bincount(pixels, share * np.repeat(deepen, entries), minlength=len(depth))
        return replace(self, depth=depth.astype(np.float32))

    def rod_covers(
        self, start: _Floats, end: _Floats, radius: _Floats, things: NDArray[np.integer[Any]], count: int
    ) -> sparse.csr_array:
        """What things made of rods cover.

        Args:
            start: (n, 3) [m].
            end: (n, 3) [m].
            radius: (n,) [m].
            things: (n,) the thing that each rod is a part of, ascending.
            count: of the things.

        Returns: (count, pixels + 1).
        """
        entries, pixels, share = self._sample_rods(start, end, radius)
        last = np.cumsum(np.bincount(things, entries, minlength=count)).astype(np.int32)
        bounds = np.concatenate([np.zeros(1, np.int32), last])
        capped = np.minimum(share, np.float32(OPAQUE))
        return sparse.csr_array((capped, pixels, bounds), shape=(count, len(self.depth)))

    def patch_covers(
        self, centre: _Floats, along: _Floats, aside: _Floats, area: _Floats, *, samples: tuple[int, int]
    ) -> sparse.csr_array:
        """What flat things cover, each sampled at a grid of points.

        Args:
            centre: (n, 3) [m].
            along: (n, 3) from its one end to the other [m].
            aside: (n, 3) from its one side to the other [m].
            area: (n,) that a parallel projection sees [m^2].
            samples: along and aside.

        Returns: (n, pixels + 1).
        """
        way = ((np.arange(samples[0]) + 0.5) / samples[0] - 0.5).astype(np.float32)
        side = ((np.arange(samples[1]) + 0.5) / samples[1] - 0.5).astype(np.float32)
        way, side = np.repeat(way, samples[1]), np.tile(side, samples[0])
        middle, one, other = self.flat(centre), self.turn(along), self.turn(aside)
        if math.isfinite(self.grid.distance):
            large = growth(centre, self.grid).astype(np.float32)
            one, other, area = one * large[:, None], other * large[:, None], area * large**2
        x, y = (middle[:, k, None] + one[:, k, None] * way + other[:, k, None] * side for k in (0, 1))
        each = len(way)
        share = np.repeat((area / (self._pixel**2 * each)).astype(np.float32), each)
        bounds = np.arange(len(centre) + 1, dtype=np.int32) * each
        covers = sparse.csr_array((share, self.index(x, y).ravel(), bounds), (len(centre), len(self.depth)))
        covers.sum_duplicates()  # side by side within a pixel
        covers.data = np.minimum(covers.data, np.float32(OPAQUE))
        return covers

    def _sample_rods(
        self, start: _Floats, end: _Floats, radius: _Floats, *, fine: int = 1
    ) -> tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.float32]]:
        """Points along rods, ``fine`` of them to a pixel, and across those that are wider than a pixel.

        Returns: number of points of each rod, and all points' pixels and shares of a pixel.
        """
        half = (radius / self._pixel).astype(np.float32)
        if math.isinf(self.grid.distance):
            first, along = self.flat(start), self.turn(end - start)
        else:
            first = self.flat(start)
            along = self.flat(end) - first
            half *= growth((start + end) / 2, self.grid).astype(np.float32)
        length = np.hypot(along[:, 0], along[:, 1])
        steps = np.maximum(np.ceil(fine * length), 1).astype(np.int32)
        across = np.maximum(np.where(2 * half > 1, np.ceil(fine * 2 * half), 1), 1).astype(np.int32)
        total = steps * across
        which = np.repeat(np.arange(len(total), dtype=np.int32), total)
        number = np.arange(len(which), dtype=np.int32) - np.repeat(
            (np.cumsum(total) - total).astype(np.int32), total
        )
        way = (number % steps[which] + np.float32(0.5)) / steps[which]
        x = first[which, 0] + along[which, 0] * way
        y = first[which, 1] + along[which, 1] * way
        if len(across) and across.max() > 1:
            share = (number // steps[which] + np.float32(0.5)) / across[which]
            side = (2 * share - 1) * (half / np.maximum(length, np.float32(1e-9)))[which]
            x, y = x - along[which, 1] * side, y + along[which, 0] * side
        share = (2 * half * length / total).astype(np.float32)
        return total, self.index(x, y), share[which]


def rod_radii(parent: NDArray[np.integer[Any]], radius: _Floats) -> NDArray[np.float64]:
    """Half the width (n,) [m] of the surface around the rod from every node's parent to it.

    A side branch begins with its own radius, and rings of few corners lie within the round branch.
    """
    width = radius.astype(np.float64)
    above = np.maximum(parent, 0)
    carries_on = (main_child(parent, radius)[above] == np.arange(len(parent))) & (parent >= 0)
    mean = np.where(carries_on, (width + width[above]) / 2, width)
    corners = np.clip(_CORNERS * np.cbrt(mean / max(float(mean.max(initial=0.0)), 1e-12)), 3, _CORNERS)
    return np.asarray(mean * np.sin(np.pi / corners) * corners / np.pi)


def lay_canvas(
    alpha: NDArray[np.float32], unknown: NDArray[np.bool_] | None, view: View, *, cell: float
) -> CoverCanvas:
    """An empty canvas for a matte, its cells counted from the foot, with a margin where nothing should be.

    Args:
        alpha: (h, w) in 0..1.
        unknown: (h, w) pixels about which the matte says nothing; None for none.
        view: where the pixels lie.
        cell: edge of a cell [m].
    """
    grid = cover_picture(alpha.shape, view, cell=cell, margin=_MARGIN)

    def means(picture: NDArray[np.float32]) -> NDArray[np.float32]:
        box = {"left": grid.left, "bottom": grid.bottom, "columns": grid.columns, "rows": grid.rows}
        return np.asarray(footprint_means(picture, view, cell=cell, **box), np.float32)  # type: ignore[arg-type]

    known = np.ones((grid.columns, grid.rows), np.float32)
    if unknown is not None and unknown.any():
        known -= _GUESSED * np.clip(means(unknown.astype(np.float32)), 0.0, 1.0)
    pixels = grid.columns * grid.rows * FINE * FINE
    return CoverCanvas(grid, means(alpha), known, np.zeros(pixels + 1, np.float32))


def lay_guess(alpha: NDArray[np.float32], view: View, *, cell: float, weight: float) -> CoverCanvas:
    """The same where no matte is but a guess, whose cells count ``weight`` instead of 1."""
    canvas = lay_canvas(alpha, None, view, cell=cell)
    return replace(canvas, known=np.float32(weight) * canvas.known)
