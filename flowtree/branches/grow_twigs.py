"""Tiny twigs that the flow does not trace (Particle Flows, section 8)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import scipy.sparse as sparse
from numpy.typing import NDArray

from flowtree.branches.find_twig_places import FREE_STREAM, TwigPlaces, append_twigs, find_twig_places
from flowtree.branches.look_up_density import look_up_density
from flowtree.branches.shape_twigs import TwigShapes, shape_twigs
from flowtree.device import side_by_side
from flowtree.geometry.choose_cover import choose_cover
from flowtree.geometry.cover_canvas import CELLS, RING, CoverCanvas, lay_canvas, lay_guess
from flowtree.geometry.footprint_means import optical_depth
from flowtree.geometry.parent_array import main_child
from flowtree.geometry.place_chance import place_chance
from flowtree.geometry.plane_grid import stem_cells
from flowtree.model.camera import Camera
from flowtree.model.guessed_view import GuessedView
from flowtree.model.matte import Matte
from flowtree.model.skeleton import Skeleton
from flowtree.model.volume import DensityVolume
from flowtree.params import TwigParams

_SHAPES = 16  # different twigs; more would not be told apart
_FULL = 0.4  # optical depth over the whole view, in squared heights, of a crown that is given all twigs
_SHEATH = 0.1  # of its length, the radius of the leaves around a twig
_BARE = 5.0  # times as many places on a bare tree, where every twig is seen
_BARE_MOST = 1.5  # times as many twigs at most, for they hide less than leaves do
_USUAL, _LEAST_LIKELY = 0.9, 0.1  # quantile of the density that is dense; chance of a place without any
_WORTH = 0.01  # alpha that must be missing where a twig would stand, in the mean over it
_OPEN = 0.9  # of the leaves around a twig at most
_STEM = 3.0  # rows no wider than this many radii of the trunk show the stem alone: no twig grows there
_BATCHES = 32
_BATCH, _CHANCE = FREE_STREAM, FREE_STREAM + 1


def grow_twigs(
    skeleton: Skeleton,
    volume: DensityVolume,
    mattes: Sequence[Matte],
    cameras: Sequence[Camera],
    *,
    between: Sequence[GuessedView] = (),
    height: float | None = None,
    leafy: bool = True,
    shapes: TwigShapes | None = None,
    params: TwigParams = TwigParams(),
    seed: int = 0,
) -> Skeleton:
    """Adds twigs to the thin branches, where and as many as the mattes ask for.

    The paper places them by rule alone, and lets the user set length, rigidity and frequency; here the rule
    offers many more places than are needed, and the mattes choose among them.

    Twigs leave their branch at ``params.angle`` and turn around it by ``params.divergence`` from one to the
    next (the Golden Section rule of section 8 with 137.5 degrees); plagiotropism bends them toward the
    horizontal, and what is not rigid hangs. Of all possible places those are taken with which the tree's
    alpha comes nearest to every matte's (see `choose_cover`): on a bare tree with the twigs' own width, on a
    leafy one with that of the leaves that they will bear; of those that serve alike, those in dense voxels
    are likelier. A place draws its own random numbers, so that a
    change in one part of a matte leaves the twigs elsewhere as they were.

    Args:
        skeleton: branches with radii.
        volume: no twig ends where it is empty.
        mattes: one a view.
        cameras: theirs.
        between: the volume from where no photograph looks: there the twigs come near its alpha.
        height: of the tree [m]; None takes the volume's.
        leafy: whether the tree bears leaves.
        shapes: of the twigs, as `copy_twig` makes them of a drawn one; None for the usual shoots.
        params: length, angle, frequency and so on.
        seed: of the places and bends.

    Returns: the skeleton with the twigs' nodes, marked in ``twig``; no twig is thicker than its branch. The
        same skeleton where there is no place for any.
    """
    height = height or volume.voxel * volume.density.shape[1]
    side_twigs = 0 if leafy else params.side_twigs
    length = height * (params.length if leafy else params.bare_length)
    random = np.random.default_rng(seed)
    if shapes is None:
        shapes = shape_twigs(
            _SHAPES, side_twigs=side_twigs, angle=params.angle, curl=params.curl, random=random
        )
    twigs = find_twig_places(
        skeleton,
        shapes,
        bears=(skeleton.parent >= 0) & (skeleton.particles <= params.bearing_particles) & ~skeleton.twig,
        frequency=(1.0 if leafy else _BARE) * params.frequency / height,
        length=length,
        height=height,
        params=params,
        seed=seed,
    )
    twigs = twigs.take(look_up_density(twigs.points[:, shapes.shoot[-1]], volume) > 0)

    def stand(matte: Matte, camera: Camera) -> CoverCanvas:
        return _stand(lay_canvas(matte.alpha, matte.unknown, camera, cell=height / CELLS), skeleton)

    def guess(view: GuessedView) -> CoverCanvas:
        return _stand(lay_guess(view.alpha, view.camera, cell=height / CELLS, weight=view.weight), skeleton)

    canvases = side_by_side(stand, mattes, cameras)
    for canvas in canvases:
        twigs = twigs.take(_worth(canvas, twigs.points[:, shapes.shoot]) > _WORTH)
    if not len(twigs.node) or params.most == 0:
        return skeleton
    sheath, share, most = None, 1.0, round(_BARE_MOST * params.most)
    if leafy:
        sheath = _SHEATH * length
        most = params.most
        share = min(_FULL * height**2 / most / (2 * sheath * length), _OPEN)

    def covers(canvas: CoverCanvas) -> sparse.csr_array:
        return _covers(canvas, skeleton, shapes, twigs, sheath=sheath, share=share)

    batch = (_BATCHES * place_chance(twigs.code, seed, twigs.number + _BATCH)).astype(np.int64)
    chance = place_chance(twigs.code, seed, twigs.number + _CHANCE)
    density = look_up_density(twigs.points[:, shapes.shoot[-1]], volume)
    likely = np.clip(density / np.quantile(density, _USUAL), _LEAST_LIKELY, 1.0)
    canvases = [*canvases, *side_by_side(guess, between)]
    chosen = choose_cover(
        canvases, side_by_side(covers, canvases), batch=batch, chance=chance, weight=likely, most=most
    )
    return append_twigs(skeleton, shapes, twigs.take(chosen))


def _worth(canvas: CoverCanvas, points: NDArray[np.float64]) -> NDArray[np.float32]:
    """Alpha that is missing in the mean over each twig's points (m, k, 3)."""
    flat = canvas.flat(points.reshape(-1, 3))
    missing = canvas.spread(canvas.missing())[canvas.index(flat[:, 0], flat[:, 1])]
    return np.asarray(missing.reshape(points.shape[:2]).mean(axis=1), np.float32)


def _stand(canvas: CoverCanvas, skeleton: Skeleton) -> CoverCanvas:
    """A view's canvas with the branches; rows that show the stem alone want no more than that."""
    canvas = canvas.with_tree(skeleton.parent, skeleton.points, skeleton.radius)
    depth = optical_depth(canvas.wanted.astype(np.float64)).ravel()
    stem = stem_cells(canvas.grid, depth, _STEM * float(skeleton.radius[0])).reshape(canvas.wanted.shape)
    wanted = np.where(stem, np.minimum(canvas.wanted, canvas.shown()), canvas.wanted)
    return replace(canvas, wanted=wanted)


def _covers(
    canvas: CoverCanvas,
    skeleton: Skeleton,
    shapes: TwigShapes,
    twigs: TwigPlaces,
    *,
    sheath: float | None,
    share: float,
) -> sparse.csr_array:
    """What each twig, or the ``sheath`` [m] of leaves around it, covers of a view: (m, pixels + 1)."""
    count, nodes = len(twigs.node), len(shapes.parent)
    base = skeleton.points[twigs.node].astype(np.float64)[:, None]
    start = np.concatenate([base, twigs.points], axis=1)[:, shapes.parent + 1].reshape(-1, 3)
    radius = RING * twigs.radius[:, None] * _mean_thickness(shapes)
    if sheath is not None:
        radius = np.full_like(radius, sheath)
    things = np.repeat(np.arange(count), nodes)
    covers = canvas.rod_covers(start, twigs.points.reshape(-1, 3), radius.ravel(), things, count)
    covers.data *= np.float32(share)
    return covers


def _mean_thickness(shapes: TwigShapes) -> NDArray[np.float64]:
    """Of the rod to each node (n,), share of the twig's radius: from ring to ring, as in `rod_radii`."""
    before = np.maximum(shapes.parent, 0)
    carries_on = main_child(shapes.parent, shapes.thickness)[before] == np.arange(len(before))
    mean = (shapes.thickness + shapes.thickness[before]) / 2
    return np.asarray(np.where(carries_on & (shapes.parent >= 0), mean, shapes.thickness))
