"""Leaves on the twigs (Particle Flows, section 8)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import scipy.sparse as sparse
from numpy.typing import NDArray

from flowtree.device import side_by_side
from flowtree.foliage.bark_likeness import visible_limbs
from flowtree.foliage.color_leaves import color_leaves
from flowtree.foliage.find_leaf_places import FREE_STREAM, LeafPlaces, bearing_way, find_leaf_places
from flowtree.foliage.make_leaf import leaf_coverage
from flowtree.foliage.pick_leaf import pick_leaf
from flowtree.foliage.spread_colors import spread_colors
from flowtree.geometry.choose_cover import choose_cover
from flowtree.geometry.cover_canvas import CELLS, FINE, CoverCanvas, lay_canvas, lay_guess
from flowtree.geometry.footprint_means import optical_depth
from flowtree.geometry.place_chance import place_chance
from flowtree.geometry.plane_grid import stem_cells
from flowtree.geometry.projection import view_axes
from flowtree.model.camera import Camera
from flowtree.model.foliage import Foliage
from flowtree.model.guessed_view import GuessedView
from flowtree.model.matte import Matte
from flowtree.model.mesh import Material, TreeMesh
from flowtree.model.skeleton import Skeleton
from flowtree.model.volume import DensityVolume
from flowtree.params import LeafParams

_FACING = 0.5  # mean of |cosine| between random leaves and a view
_STEM = 3.0  # rows no wider than this many radii of the trunk show the stem alone
_PLENTY = 16_000  # leaves that are many enough to be chosen well
_SMALLEST = 0.65  # factor to the length of a leaf, where fewer would do
_WORTH = 0.01  # alpha that must be missing where a leaf would hang
_PLACES = 80_000  # looked at, at most
_STEPS = 8  # of a leaf's length and of the places' number, to each doubling
_FEWEST, _FINEST = 2, 5  # points along and across a leaf at which it is looked up
_BATCHES = 32
_BATCH, _CHANCE = FREE_STREAM, FREE_STREAM + 1


def place_leaves(
    skeleton: Skeleton,
    volume: DensityVolume,
    mattes: Sequence[Matte],
    cameras: Sequence[Camera],
    *,
    between: Sequence[GuessedView] = (),
    height: float | None = None,
    leaf: tuple[TreeMesh, Material] | None = None,
    colors: Sequence[NDArray[np.float32]] | None = None,
    params: LeafParams = LeafParams(),
    seed: int = 0,
) -> Foliage | None:
    """Puts leaves on twigs and thin branches, as many in each place as density and mattes ask for.

    Places follow each other along a twig by the Golden Section rule; a leaf leaves its twig at
    ``params.angle``, and plagiotropism turns its upper side to the sky. There are many times more places than
    leaves. Which of them bear a leaf is decided in a closed loop (see `choose_cover`): the tree's alpha is to
    come near every matte's, its holes included. It starts from a draw by the density of the places' voxels,
    and of places that serve the mattes alike those in dense voxels are likelier. No leaf projects onto empty
    parts of a matte. The leaf's colour is the photo's where it projects. A place draws its own random
    numbers, so that a change in one part of a matte leaves the leaves elsewhere as they were.

    Args:
        skeleton: with radii and twigs.
        volume: the densities.
        mattes: one a view.
        cameras: theirs.
        between: the volume from where no photograph looks: there the leaves come near its alpha.
        height: of the tree [m]; None takes the volume's.
        leaf: what `pick_leaf` gives for the same mattes, where it was asked before.
        colors: what `spread_colors` gives for each matte, where it was asked before.
        params: shape, size, amount, angles.
        seed: of all that is random.

    Returns: the leaves; None where the mattes leave no room for any.

    Raises:
        InputError: a leaf picture that cannot be used.
    """
    height = height or volume.voxel * volume.density.shape[1]
    blade, material = pick_leaf(mattes, cameras, params=params, seed=seed) if leaf is None else leaf
    coverage = leaf_coverage(blade, material)

    def stand(matte: Matte, camera: Camera) -> CoverCanvas:
        return _stand(matte, camera, skeleton, height, params)

    def guess(view: GuessedView) -> CoverCanvas:
        return _stand_between(view, skeleton, height, params)

    canvases = side_by_side(stand, mattes, cameras)
    area = float(np.mean([_missing_area(canvas) for canvas in canvases])) / _FACING
    if area < coverage * (0.25 * params.size * height) ** 2:
        return None
    usual = params.size * height
    count = area / (coverage * usual**2)
    # Leaves no larger than the gaps between them, where that does not make too many to choose well.
    small = float(np.clip(np.sqrt(count / _PLENTY), _SMALLEST, 1.0))
    length = usual * _step_up(max(small, float(np.sqrt(count / params.most))))
    wanted = area / (coverage * length**2)
    places = _offer_places(skeleton, params, wanted, length, height, seed)
    for canvas in canvases:
        flat = canvas.flat(places.centre)
        places = places.take(canvas.spread(canvas.missing())[canvas.index(flat[:, 0], flat[:, 1])] > _WORTH)
    if not len(places.node):
        return None
    width = float(np.ptp(blade.positions[:, 0]))
    likely = _density_shares(places, volume, wanted)
    chance = place_chance(places.code, seed, places.number + _CHANCE)

    def covers(canvas: CoverCanvas) -> sparse.csr_array:
        return _covers(canvas, places, coverage, width)

    canvases = [*canvases, *side_by_side(guess, between)]
    chosen = choose_cover(
        canvases,
        side_by_side(covers, canvases),
        batch=(_BATCHES * place_chance(places.code, seed, places.number + _BATCH)).astype(np.int64),
        chance=chance,
        start=chance < likely,
        weight=np.clip(likely / max(float(np.quantile(likely, 0.9)), 1e-9), 0.1, 1.0),
        most=params.most,
    )
    places = places.take(chosen)
    if not len(places.node):
        return None
    colors = side_by_side(spread_colors, mattes, cameras) if colors is None else colors
    return Foliage(
        leaf=blade,
        material=material,
        position=places.position.astype(np.float32),
        rotation=places.rotation.astype(np.float32),
        scale=places.length.astype(np.float32),
        color=color_leaves(
            places.centre, mattes, colors, cameras, variation=params.color_variation, seed=seed
        ),
        node=places.node.astype(np.int32),
        rounding=params.rounding,
    )


def _stand(
    matte: Matte, camera: Camera, skeleton: Skeleton, height: float, params: LeafParams
) -> CoverCanvas:
    """A view's canvas with the wood; where limbs or the stem alone are seen no leaf is wanted."""
    cell = height / CELLS
    limbs = visible_limbs(matte, camera)
    canvas = lay_canvas(matte.alpha * (1.0 - limbs), matte.unknown, camera, cell=cell)
    bark = lay_canvas(matte.alpha * limbs, None, camera, cell=cell).wanted
    stood = canvas.with_tree(skeleton.parent, skeleton.points, skeleton.radius)
    return replace(stood, wanted=_leafy(canvas, skeleton, params) + np.minimum(bark, stood.shown()))


def _stand_between(view: GuessedView, skeleton: Skeleton, height: float, params: LeafParams) -> CoverCanvas:
    """The same where only the volume says what is wanted."""
    canvas = lay_guess(view.alpha, view.camera, cell=height / CELLS, weight=view.weight)
    stood = canvas.with_tree(skeleton.parent, skeleton.points, skeleton.radius)
    return replace(stood, wanted=_leafy(canvas, skeleton, params))


def _leafy(canvas: CoverCanvas, skeleton: Skeleton, params: LeafParams) -> NDArray[np.float32]:
    """Alpha that leaves should show in each cell: none where the stem alone is seen."""
    depth = optical_depth(canvas.wanted.astype(np.float64))
    stem = stem_cells(canvas.grid, depth.ravel(), _STEM * float(skeleton.radius[0])).reshape(depth.shape)
    return np.where(stem, 0.0, -np.expm1(-params.amount * depth)).astype(np.float32)


def _missing_area(canvas: CoverCanvas) -> float:
    """Area [m^2] of leaves, as they are turned to the view, that its cells lack."""
    wanted, shown = (optical_depth(a.astype(np.float64)) for a in (canvas.wanted, canvas.shown()))
    return float((np.maximum(wanted - shown, 0.0) * canvas.known).sum()) * canvas.grid.cell**2


def _step_up(factor: float) -> float:
    """The next of a few factors: what hangs on all of a matte must not change with a bit of it."""
    return float(np.exp2(np.ceil(_STEPS * np.log2(factor)) / _STEPS))


def _offer_places(
    skeleton: Skeleton, params: LeafParams, wanted: float, length: float, height: float, seed: int
) -> LeafPlaces:
    """``params.choice`` times ``wanted`` places, evenly along everything thin."""
    way = float(bearing_way(skeleton, params).sum())
    often = min(wanted * params.choice, _PLACES) / max(way / length, 1e-9)
    rate = params.densest / _step_up(max(params.densest / max(often, 1e-9), 1.0)) / length
    return find_leaf_places(skeleton, rate=rate, length=length, height=height, params=params, seed=seed)


def _density_shares(places: LeafPlaces, volume: DensityVolume, wanted: float) -> NDArray[np.float64]:
    """Shares in proportion to density over the number of places in the same voxel; ``wanted`` together."""
    last = np.array(volume.density.shape) - 1
    voxel = np.clip(np.floor((places.centre - volume.origin) / volume.voxel).astype(int), 0, last)
    flat = np.ravel_multi_index(tuple(voxel.T), volume.density.shape)
    crowd = np.bincount(flat, minlength=volume.density.size)
    share = volume.density.ravel()[flat] / crowd[flat]
    return np.asarray(np.minimum(share * wanted / max(float(share.sum()), 1e-9), 1.0))


def _covers(canvas: CoverCanvas, places: LeafPlaces, coverage: float, width: float) -> sparse.csr_array:
    """What each leaf covers of a view: its area as it is turned there, over its blade."""
    facing = np.abs(places.normal @ view_axes(canvas.grid.yaw)[2])
    across = width * places.length[:, None] * np.cross(places.along, places.normal)
    longest = float(places.length.max()) / (canvas.grid.cell / FINE)
    samples = (_points(longest), _points(width * longest))
    area = coverage * places.length**2 * facing
    along = places.length[:, None] * places.along
    return canvas.patch_covers(places.centre, along, across, area, samples=samples)


def _points(pixels: float) -> int:
    return int(np.clip(np.ceil(pixels), _FEWEST, _FINEST))
