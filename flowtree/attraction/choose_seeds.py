"""Where livewire paths begin."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from flowtree.attraction.cut_working_grid import WorkingGrid
from flowtree.attraction.outline_crown import CrownOutline
from flowtree.attraction.trace_drawn_pixels import trace_drawn_pixels
from flowtree.geometry.polylines import arc_lengths

_SNAP = 0.03  # of the height: how far a seed moves from the closed outline to the twig behind it

_BARE = 0.45  # mean alpha inside the outline up to which a crown is bare or open enough to show twigs
_TWIG = 0.2  # alpha of a twig at least
_TWIG_LENGTH = 0.045  # of the height: shorter ends are leaves
_TWIG_APART = 0.08  # of the height: how far a twig's end lies from other seeds
_GROUND = 0.04  # of the height above the foot: no seeds in grass
_UNDERSIDE = 0.75  # cosine: an outline that faces down more steeply is the crown's underside


def choose_seeds(
    grid: WorkingGrid,
    crown: CrownOutline,
    *,
    count: int,
    mode: Literal["farthest", "random"],
    rng: np.random.Generator,
    hanging: bool = False,
) -> NDArray[np.intp]:
    """Seed cells on the silhouette of the crown (Particle Flows, section 4).

    The paper draws them at random; ``farthest`` spreads them instead: each is the point of the silhouette
    farthest from all before it, from the crown's top on. Every seed then moves to the densest cell near it.
    A bare tree gets up to a third as many again at ends of twigs far from those, wherever they lie.

    Args:
        grid: the working picture.
        crown: its filled shape.
        count: of seeds on the silhouette at most.
        mode: how they are spread.
        rng: for ``mode`` random.
        hanging: branches end at the crown's underside, too.

    Returns: (k, 2) (row, column), those on the silhouette first.
    """
    rim = _silhouette(crown, grid.tall, underside=hanging)
    if count == 0 or len(rim) == 0:
        return np.zeros((0, 2), np.intp)
    if mode == "random":
        picked = rim[rng.choice(len(rim), size=min(count, len(rim)), replace=False)]
        picked = picked[np.argsort(picked[:, 0], kind="stable")]
    else:
        picked = rim[spread_points(rim, count)]
    snapped = np.concatenate([_snap(picked, grid), _twig_ends(grid, crown, picked, count // 3)])
    _, first = np.unique(snapped, axis=0, return_index=True)
    return snapped[np.sort(first)]


def spread_points(
    points: NDArray[np.intp], count: int, given: NDArray[np.intp] | None = None, apart: float = 0.0
) -> NDArray[np.intp]:
    """Farthest-point sampling over the points (n, 2).

    Args:
        points: to choose from, n >= 1.
        count: how many at most, >= 1.
        given: (m, 2) from which the chosen ones stay away; without any the first point is chosen first.
        apart: chosen points are farther than this from each other and from the given ones.

    Returns: (k,) indices, k <= count.
    """
    order: list[int] = []
    if given is None or len(given) == 0:
        order.append(0)
        distance = np.linalg.norm(points - points[0], axis=1)
    else:
        distance = np.linalg.norm(points[:, None] - given[None], axis=2).min(axis=1)
    while len(order) < min(count, len(points)):
        following = int(distance.argmax())
        if distance[following] <= apart:
            break
        order.append(following)
        distance = np.minimum(distance, np.linalg.norm(points - points[following], axis=1))
    return np.array(order, np.intp)


def _silhouette(crown: CrownOutline, tall: float, *, underside: bool) -> NDArray[np.intp]:
    """The rim cells (n, 2) of the crown, top row first; the stem's sides are no place for a seed."""
    shape = np.pad(crown.shape, 1)
    rim = (shape & ~ndimage.binary_erosion(shape))[1:-1, 1:-1]
    # The underside of a crown that does not hang carries few branches: no seeds where it faces the ground.
    blurred = ndimage.gaussian_filter(crown.shape.astype(np.float64), max(1.0, 0.02 * tall))
    down, right = np.gradient(blurred)
    below = -down > _UNDERSIDE * np.hypot(down, right) + 1e-12
    cells = np.argwhere(rim if underside else rim & ~below)
    in_crown = cells[cells[:, 0] <= min(crown.base, crown.foot - _GROUND * tall)]
    return in_crown if len(in_crown) else cells[:1]


def _twig_ends(
    grid: WorkingGrid, crown: CrownOutline, seeds: NDArray[np.intp], count: int
) -> NDArray[np.intp]:
    """Free ends (k, 2) of long thin parts of a bare tree's matte, k <= count, away from the seeds."""
    none = np.zeros((0, 2), np.intp)
    if count == 0 or float(grid.alpha[crown.shape].mean()) > _BARE:
        return none
    chains = trace_drawn_pixels((grid.alpha > _TWIG) & crown.shape)
    chains = [chain for chain in chains if arc_lengths(chain)[-1] >= _TWIG_LENGTH * grid.tall]
    if not chains:
        return none
    ends = np.concatenate([chain[[0, -1]] for chain in chains])
    cells, uses = np.unique(grid.cell_at(ends), axis=0, return_counts=True)
    highest = min(crown.base, crown.foot - _GROUND * grid.tall)
    free = cells[(uses == 1) & (cells[:, 0] <= highest)]
    if len(free) == 0:
        return none
    return np.asarray(free[spread_points(free, count, seeds, _TWIG_APART * grid.tall)])


def _snap(cells: NDArray[np.intp], grid: WorkingGrid) -> NDArray[np.intp]:
    reach = max(1, round(_SNAP * grid.tall))
    offset = np.mgrid[-reach : reach + 1, -reach : reach + 1].reshape(2, -1).T
    offset = offset[np.linalg.norm(offset, axis=1) <= reach]
    near = cells[:, None, :] + offset[None, :, :]
    inside = np.clip(near, 0, np.array(grid.alpha.shape) - 1)
    worth = (
        np.minimum(grid.alpha[inside[..., 0], inside[..., 1]], 0.5)
        - 0.3 * np.linalg.norm(offset, axis=1) / reach
    )
    return np.asarray(inside[np.arange(len(cells)), worth.argmax(axis=1)])
