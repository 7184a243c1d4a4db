"""Leaves on the twigs (Particle Flows, section 8)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sparse
from numpy.typing import NDArray

from flowtree.foliage.bark_likeness import visible_limbs
from flowtree.foliage.choose_leaf import choose_leaf
from flowtree.foliage.color_leaves import color_leaves
from flowtree.foliage.make_leaf import leaf_coverage, make_leaf
from flowtree.geometry.frames import quaternions, side_axes, unit
from flowtree.geometry.match_depths import draw_shares, match_depths
from flowtree.geometry.morton import morton_order
from flowtree.geometry.parent_array import sum_before
from flowtree.geometry.plane_grid import PlaneGrid, narrow_rows, seen_depth, splat_matrix
from flowtree.geometry.projection import view_axes
from flowtree.geometry.segment_depth import rods_depth
from flowtree.model.camera import Camera
from flowtree.model.foliage import Foliage
from flowtree.model.matte import Matte
from flowtree.model.skeleton import Skeleton
from flowtree.model.volume import DensityVolume
from flowtree.params import LeafParams

_CELLS = 80  # along the height, of the grids on which leaves are chosen: about a leaf wide
_FACING = 0.5  # mean of |cosine| between random leaves and a view
_STEM = 3.0  # rows no wider than this many radii of the trunk show the stem alone
_SPARSE = 0.02  # alpha of a cell below which no leaf may project there


def place_leaves(
    skeleton: Skeleton,
    volume: DensityVolume,
    mattes: Sequence[Matte],
    cameras: Sequence[Camera],
    *,
    params: LeafParams = LeafParams(),
    seed: int = 0,
) -> Foliage | None:
    """Puts leaves on twigs and thin branches, as many in each place as density and mattes ask for.

    Places follow each other along a twig by the Golden Section rule; a leaf leaves its twig at
    ``params.angle``, and plagiotropism turns its upper side to the sky. There are several times more places
    than leaves. How likely a place is comes from the density of its voxel; then the shares of all places are
    matched to the optical depth of every matte, so that the sum of leaves and wood has the matte's alpha, and
    places that project onto empty or sparse parts of a matte are dropped. The leaf's colour is the photo's
    where it projects.

    Args:
        skeleton: with radii and twigs.
        volume: the densities.
        mattes: one a view.
        cameras: theirs.
        params: shape, size, amount, angles.
        seed: of all that is random.

    Returns: the leaves; None where the mattes leave no room for any.

    Raises:
        InputError: a leaf picture that cannot be used.
    """
    height = volume.voxel * volume.density.shape[1]
    shape = choose_leaf(mattes, cameras) if params.shape == "auto" else params.shape
    leaf, material = make_leaf(shape, color=(0.8, 0.8, 0.8), seed=seed, picture=params.picture)
    coverage = leaf_coverage(leaf, material)
    grids, targets = [], []
    for matte, camera in zip(mattes, cameras, strict=True):
        leafy = matte.alpha * (1.0 - visible_limbs(matte, camera))
        grid, seen = seen_depth(leafy, camera, cell=height / _CELLS)
        wood = rods_depth(grid, skeleton.parent, skeleton.points, skeleton.radius)
        bare = (seen < _SPARSE) | narrow_rows(grid, seen, _STEM * float(skeleton.radius[0]))
        grids.append(grid)
        targets.append(np.where(bare, 0.0, np.maximum(seen * params.amount - wood, 0.0)))
    area = float(np.mean([t.sum() for t in targets])) * grids[0].cell ** 2 / _FACING
    if area < coverage * (0.25 * params.size * height) ** 2:
        return None
    length = max(params.size * height, float(np.sqrt(area / (coverage * params.most))))
    wanted = area / (coverage * length**2)
    random = np.random.default_rng(seed)
    places = _find_places(skeleton, params, wanted * params.choice, length, random)
    if not len(places.node):
        return None
    matrices = [_leaf_depth(grid, places, coverage) for grid in grids]
    shares = match_depths(matrices, targets, _density_shares(places, volume, wanted))
    excess = max(float(shares.sum()) / params.most, 1.0)  # fewer and larger ones cover as much
    shares /= excess
    places = replace(places, length=places.length * np.sqrt(excess))
    order = morton_order(places.centre)
    chosen = np.zeros(len(shares), np.bool_)
    chosen[order] = draw_shares(shares[order], seed=seed)
    places = places.take(chosen)
    if not len(places.node):
        return None
    return Foliage(
        leaf=leaf,
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
    """Leaves that could grow: (m,) node and length [m], (m, 3) stalk's end [m], unit blade and upper side."""

    node: NDArray[np.int64]
    length: NDArray[np.float64]
    position: NDArray[np.float64]
    along: NDArray[np.float64]
    normal: NDArray[np.float64]

    @property
    def centre(self) -> NDArray[np.float64]:
        """(m, 3) middle of the blade [m]."""
        return self.position + 0.5 * self.length[:, None] * self.along

    def take(self, which: NDArray[np.bool_]) -> _Places:
        return _Places(
            self.node[which], self.length[which], self.position[which], self.along[which], self.normal[which]
        )


def _find_places(
    skeleton: Skeleton, params: LeafParams, wanted: float, length: float, random: np.random.Generator
) -> _Places:
    """About ``wanted`` places, evenly along everything thin, in phyllotactic order."""
    parent = skeleton.parent
    segment = skeleton.points.astype(np.float64) - skeleton.points[np.maximum(parent, 0)]
    bears = (parent >= 0) & (skeleton.twig | (skeleton.particles <= params.bearing_particles))
    way = np.linalg.norm(segment, axis=1) * bears
    rate = min(wanted / max(float(way.sum()), 1e-9), params.densest / length)
    count = np.floor(way * rate + random.random(len(parent))).astype(int) * bears
    before = sum_before(parent, count)
    node = np.repeat(np.arange(len(parent)), count)
    index = np.arange(len(node)) - np.repeat(np.cumsum(count) - count, count)
    share = (index + random.random(len(node))) / np.maximum(count[node], 1)
    position = skeleton.points[node] - segment[node] * (1.0 - share[:, None])
    axis = unit(segment[node])
    first, second = side_axes(axis)
    turn = np.radians((before[node] + index) * params.divergence + random.normal(0.0, 20.0, len(node)))[
        :, None
    ]
    lean = np.radians(params.angle * random.uniform(0.6, 1.3, len(node)))[:, None]
    along = np.cos(lean) * axis + np.sin(lean) * (np.cos(turn) * first + np.sin(turn) * second)
    along = unit(along + np.array([0.0, -params.hang, 0.0]) + random.normal(0.0, 0.15, (len(node), 3)))
    over, aside = side_axes(along)
    roll = random.normal(0.0, 1.0, len(node)) * (1.0 - params.plagiotropism) * np.pi / 2
    normal = np.cos(roll)[:, None] * over + np.sin(roll)[:, None] * aside
    size = length * random.uniform(0.75, 1.25, len(node))
    return _Places(node, size, position, along, normal)


def _density_shares(places: _Places, volume: DensityVolume, wanted: float) -> NDArray[np.float64]:
    """Shares in proportion to density over the number of places in the same voxel; ``wanted`` together."""
    last = np.array(volume.density.shape) - 1
    voxel = np.clip(np.floor((places.centre - volume.origin) / volume.voxel).astype(int), 0, last)
    flat = np.ravel_multi_index(tuple(voxel.T), volume.density.shape)
    crowd = np.bincount(flat, minlength=volume.density.size)
    share = volume.density.ravel()[flat] / crowd[flat]
    return np.asarray(np.minimum(share * wanted / max(float(share.sum()), 1e-9), 1.0))


def _leaf_depth(grid: PlaneGrid, places: _Places, coverage: float) -> sparse.csr_array:
    """Depth of each place's leaf: its area as it is turned to the view."""
    facing = np.abs(places.normal @ view_axes(grid.yaw)[2])
    area = coverage * places.length**2 * facing
    count = len(places.node)
    return splat_matrix(grid, places.centre, area, np.arange(count), count)
