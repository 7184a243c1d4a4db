"""Leaves on the twigs (Particle Flows, section 8)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace

import numpy as np
import scipy.sparse as sparse
from numpy.typing import NDArray
from scipy.special import ndtri

from flowtree.device import side_by_side
from flowtree.foliage.bark_likeness import visible_limbs
from flowtree.foliage.color_leaves import color_leaves
from flowtree.foliage.make_leaf import leaf_coverage
from flowtree.foliage.pick_leaf import pick_leaf
from flowtree.geometry.choose_cover import choose_cover
from flowtree.geometry.cover_canvas import CELLS, FINE, CoverCanvas, lay_canvas
from flowtree.geometry.footprint_means import optical_depth
from flowtree.geometry.frames import quaternions, side_axes, unit
from flowtree.geometry.parent_array import sum_before
from flowtree.geometry.place_chance import place_chance
from flowtree.geometry.place_code import place_code
from flowtree.geometry.plane_grid import narrow_rows
from flowtree.geometry.projection import view_axes
from flowtree.model.camera import Camera
from flowtree.model.foliage import Foliage
from flowtree.model.matte import Matte
from flowtree.model.mesh import Material, TreeMesh
from flowtree.model.skeleton import Skeleton
from flowtree.model.volume import DensityVolume
from flowtree.params import LeafParams

_FACING = 0.5  # mean of |cosine| between random leaves and a view
_STEM = 3.0  # rows no wider than this many radii of the trunk show the stem alone
_WORTH = 0.01  # alpha that must be missing where a leaf would hang
_PLACES = 80_000  # looked at, at most
_STEPS = 8  # of a leaf's length and of the places' number, to each doubling
_FEWEST, _FINEST = 2, 5  # points along and across a leaf at which it is looked up
_BATCHES = 32
_STREAMS = 16  # random numbers of a place
_COUNT, _WAY, _TURN, _LEAN, _BEND, _ROLL, _SIZE, _BATCH, _CHANCE = 0, 1, 2, 3, 4, 7, 8, 9, 10


def place_leaves(
    skeleton: Skeleton,
    volume: DensityVolume,
    mattes: Sequence[Matte],
    cameras: Sequence[Camera],
    *,
    height: float | None = None,
    leaf: tuple[TreeMesh, Material] | None = None,
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
        height: of the tree [m]; None takes the volume's.
        leaf: what `pick_leaf` gives for the same mattes, where it was asked before.
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

    canvases = side_by_side(stand, mattes, cameras)
    area = float(np.mean([_missing_area(canvas) for canvas in canvases])) / _FACING
    if area < coverage * (0.25 * params.size * height) ** 2:
        return None
    least = params.size * height
    length = least * _step_up(float(np.sqrt(area / (coverage * params.most))) / least)
    wanted = area / (coverage * length**2)
    places = _find_places(skeleton, params, wanted, length, height, seed)
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
    return Foliage(
        leaf=blade,
        material=material,
        position=places.position.astype(np.float32),
        rotation=quaternions(np.cross(places.along, places.normal), places.along, places.normal).astype(
            np.float32
        ),
        scale=places.length.astype(np.float32),
        color=color_leaves(places.centre, mattes, cameras, variation=params.color_variation, seed=seed),
        node=places.node.astype(np.int32),
    )


@dataclass(frozen=True)
class _Places:
    """Leaves that could grow.

    Attributes:
        node: (m,) the skeleton's node on whose segment each grows.
        length: (m,) [m].
        position: (m, 3) stalk's end [m].
        along: (m, 3) unit, the blade's.
        normal: (m, 3) unit, the upper side's.
        code: (m,) of the node, for the place's random numbers.
        number: (m,) the first of them.
    """

    node: NDArray[np.int64]
    length: NDArray[np.float64]
    position: NDArray[np.float64]
    along: NDArray[np.float64]
    normal: NDArray[np.float64]
    code: NDArray[np.int64]
    number: NDArray[np.int64]

    @property
    def centre(self) -> NDArray[np.float64]:
        """(m, 3) middle of the blade [m]."""
        return self.position + 0.5 * self.length[:, None] * self.along

    def take(self, which: NDArray[np.bool_]) -> _Places:
        return _Places(**{field.name: getattr(self, field.name)[which] for field in fields(self)})


def _stand(
    matte: Matte, camera: Camera, skeleton: Skeleton, height: float, params: LeafParams
) -> CoverCanvas:
    """A view's canvas with the wood; where limbs or the stem alone are seen no leaf is wanted."""
    cell = height / CELLS
    limbs = visible_limbs(matte, camera)
    canvas = lay_canvas(matte.alpha * (1.0 - limbs), matte.unknown, camera, cell=cell)
    depth = optical_depth(canvas.wanted.astype(np.float64))
    stem = narrow_rows(canvas.grid, depth.ravel(), _STEM * float(skeleton.radius[0])).reshape(depth.shape)
    leafy = np.where(stem, 0.0, -np.expm1(-params.amount * depth)).astype(np.float32)
    bark = lay_canvas(matte.alpha * limbs, None, camera, cell=cell).wanted
    stood = canvas.with_tree(skeleton.parent, skeleton.points, skeleton.radius)
    return replace(stood, wanted=leafy + np.minimum(bark, stood.shown()))


def _missing_area(canvas: CoverCanvas) -> float:
    """Area [m^2] of leaves, as they are turned to the view, that its cells lack."""
    wanted, shown = (optical_depth(a.astype(np.float64)) for a in (canvas.wanted, canvas.shown()))
    return float((np.maximum(wanted - shown, 0.0) * canvas.known).sum()) * canvas.grid.cell**2


def _step_up(factor: float) -> float:
    """The next of a few factors from 1 on: what hangs on all of a matte must not change with a bit of it."""
    return float(np.exp2(np.ceil(_STEPS * np.log2(max(factor, 1.0))) / _STEPS))


def _find_places(
    skeleton: Skeleton, params: LeafParams, wanted: float, length: float, height: float, seed: int
) -> _Places:
    """``params.choice`` times ``wanted`` places, evenly along everything thin, in phyllotactic order."""
    parent = skeleton.parent
    segment = skeleton.points.astype(np.float64) - skeleton.points[np.maximum(parent, 0)]
    bears = (parent >= 0) & (skeleton.twig | (skeleton.particles <= params.bearing_particles))
    way = np.linalg.norm(segment, axis=1) * bears
    often = min(wanted * params.choice, _PLACES) / max(float(way.sum()) / length, 1e-9)
    rate = params.densest / _step_up(params.densest / max(often, 1e-9)) / length
    codes = place_code(skeleton.points, height)
    count = np.floor(way * rate + place_chance(codes, seed, _COUNT)).astype(np.int64) * bears
    before = sum_before(parent, count)
    node = np.repeat(np.arange(len(parent)), count)
    index = np.arange(len(node)) - np.repeat(np.cumsum(count) - count, count)
    code, number = codes[node], (1 + index) * _STREAMS

    def between(low: float, high: float, stream: int) -> NDArray[np.float64]:
        return low + (high - low) * place_chance(code, seed, number + stream)

    def normal(stream: int) -> NDArray[np.float64]:
        return np.asarray(ndtri(between(1e-9, 1.0 - 1e-9, stream)))

    share = (index + between(0.0, 1.0, _WAY)) / np.maximum(count[node], 1)
    position = skeleton.points[node] - segment[node] * (1.0 - share[:, None])
    axis = unit(segment[node])
    first, second = side_axes(axis)
    turn = np.radians((before[node] + index) * params.divergence + 20.0 * normal(_TURN))[:, None]
    lean = np.radians(params.angle * between(0.6, 1.3, _LEAN))[:, None]
    along = np.cos(lean) * axis + np.sin(lean) * (np.cos(turn) * first + np.sin(turn) * second)
    bend = 0.15 * np.stack([normal(_BEND + k) for k in range(3)], axis=1)
    along = unit(along + np.array([0.0, -params.hang, 0.0]) + bend)
    over, aside = side_axes(along)
    roll = normal(_ROLL) * (1.0 - params.plagiotropism) * np.pi / 2
    upper = np.cos(roll)[:, None] * over + np.sin(roll)[:, None] * aside
    return _Places(node, length * between(0.75, 1.25, _SIZE), position, along, upper, code, number)


def _density_shares(places: _Places, volume: DensityVolume, wanted: float) -> NDArray[np.float64]:
    """Shares in proportion to density over the number of places in the same voxel; ``wanted`` together."""
    last = np.array(volume.density.shape) - 1
    voxel = np.clip(np.floor((places.centre - volume.origin) / volume.voxel).astype(int), 0, last)
    flat = np.ravel_multi_index(tuple(voxel.T), volume.density.shape)
    crowd = np.bincount(flat, minlength=volume.density.size)
    share = volume.density.ravel()[flat] / crowd[flat]
    return np.asarray(np.minimum(share * wanted / max(float(share.sum()), 1e-9), 1.0))


def _covers(canvas: CoverCanvas, places: _Places, coverage: float, width: float) -> sparse.csr_array:
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
