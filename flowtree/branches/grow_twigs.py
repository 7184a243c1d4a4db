"""Tiny twigs that the flow does not trace (Particle Flows, section 8)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sparse
from numpy.typing import NDArray

from flowtree.branches.order_branches import order_branches
from flowtree.branches.shape_twigs import TwigShapes, shape_twigs
from flowtree.geometry.frames import side_axes, unit
from flowtree.geometry.match_depths import draw_shares, match_depths
from flowtree.geometry.morton import morton_order
from flowtree.geometry.parent_array import parents_first, sum_before
from flowtree.geometry.plane_grid import PlaneGrid, narrow_rows, seen_depth
from flowtree.geometry.segment_depth import rods_depth, segment_depth
from flowtree.model.camera import Camera
from flowtree.model.matte import Matte
from flowtree.model.skeleton import Skeleton
from flowtree.model.volume import DensityVolume
from flowtree.params import TwigParams

_SHAPES = 16  # different twigs; more would not be told apart
_STEM = 3.0  # rows no wider than this many radii of the trunk show the stem alone: no twig grows there
_DENSEST = 2.5  # optical depth that twigs alone can have
_FULL = 0.25  # depth over the whole view, in squared heights, of a crown that is given all twigs
_SLIMMER = 0.8  # times its branch's radius, a twig's at most
_CELLS = 64  # along the height, of the grids on which the twigs are chosen


def grow_twigs(
    skeleton: Skeleton,
    volume: DensityVolume,
    mattes: Sequence[Matte],
    cameras: Sequence[Camera],
    *,
    leafy: bool = True,
    params: TwigParams = TwigParams(),
    seed: int = 0,
) -> Skeleton:
    """Adds twigs to the thin branches, where and as many as the mattes ask for.

    The paper places them by rule alone, and lets the user set length, rigidity and frequency; here the rule
    offers places, and the mattes choose among them.

    Twigs leave their branch at ``params.angle`` and turn around it by ``params.divergence`` from one to the
    next (the Golden Section rule of section 8 with 137.5 degrees); plagiotropism bends them toward the
    horizontal, and what is not rigid hangs. Of all possible places those are taken that together, with the
    wood that is already there, give every matte its optical depth: on a bare tree by the twigs' own width, on
    a leafy one by the leaves that they will bear.

    Args:
        skeleton: branches with radii.
        volume: no twig ends where it is empty; its height is the tree's.
        mattes: one a view.
        cameras: theirs.
        leafy: whether the tree bears leaves.
        params: length, angle, frequency and so on.
        seed: of the places and bends.

    Returns: the skeleton with the twigs' nodes, marked in ``twig``; no twig is thicker than its branch. The
        same skeleton where there is no place for any.
    """
    height = volume.voxel * volume.density.shape[1]
    random = np.random.default_rng(seed)
    side_twigs = 0 if leafy else params.side_twigs
    length = height * (params.length if leafy else params.bare_length)
    shapes = shape_twigs(_SHAPES, side_twigs=side_twigs, angle=params.angle, curl=params.curl, random=random)
    twigs = _find_places(skeleton, shapes, params, height, length, random)
    twigs = twigs.take(_inside(twigs.points[:, 2], volume))
    if not len(twigs.node):
        return skeleton
    matrices, targets = [], []
    for matte, camera in zip(mattes, cameras, strict=True):
        grid, wanted = seen_depth(matte.alpha, camera, cell=height / _CELLS)
        wood = rods_depth(grid, skeleton.parent, skeleton.points, skeleton.radius)
        # Twigs are lace: what is denser than this is limbs, and no number of twigs makes a limb.
        room = np.maximum(np.minimum(wanted, _DENSEST) - wood, 0.0)
        stem = narrow_rows(grid, wanted, _STEM * float(skeleton.radius[0]))
        targets.append(np.where(stem, 0.0, room))
        matrices.append(_twig_depth(grid, skeleton, shapes, twigs))
    crown = float(np.mean([t.sum() for t in targets])) / _CELLS**2  # of a full one about the height squared
    aim = params.most * min(crown / _FULL, 1.0)
    start = np.full(len(twigs.node), min(aim / len(twigs.node), 1.0))
    offered = sum(float((m @ start).sum()) for m in matrices)
    missing = sum(float(t.sum()) for t in targets) / max(offered, 1e-9)
    if leafy:  # a twig stands for the leaves on it: as many as aimed at make up for all leaves
        matrices = [m * missing for m in matrices]
    else:  # a few more twigs than aimed at, and somewhat thicker ones, rather than several times as many
        thicker = twigs.radius * float(np.clip(missing, 1.0, params.thickest))
        radius = np.minimum(thicker, _SLIMMER * skeleton.radius[twigs.node])
        gain = radius / np.maximum(twigs.radius, 1e-12)
        matrices = [sparse.csr_array(m @ sparse.diags_array(gain)) for m in matrices]
        twigs = replace(twigs, radius=radius)
    shares = match_depths(matrices, targets, start)
    order = morton_order(skeleton.points[twigs.node])
    chosen = np.zeros(len(shares), np.bool_)
    chosen[order] = draw_shares(shares[order], seed=seed)
    return _append(skeleton, shapes, twigs.take(chosen))


@dataclass(frozen=True)
class _Twigs:
    """Twigs that could grow.

    Attributes:
        node: (m,) the skeleton's node that each grows from.
        points: (m, n, 3) [m], world.
        radius: (m,) at the base [m].
    """

    node: NDArray[np.int64]
    points: NDArray[np.float64]
    radius: NDArray[np.float64]

    def take(self, which: NDArray[np.bool_]) -> _Twigs:
        return _Twigs(self.node[which], self.points[which], self.radius[which])


def _find_places(
    skeleton: Skeleton,
    shapes: TwigShapes,
    params: TwigParams,
    height: float,
    mean_length: float,
    random: np.random.Generator,
) -> _Twigs:
    """All twigs on branches thin enough to bear them, in phyllotactic order along each branch."""
    parent = skeleton.parent
    bears = (parent >= 0) & (skeleton.particles <= params.bearing_particles) & ~skeleton.twig
    segment = skeleton.points.astype(np.float64) - skeleton.points[np.maximum(parent, 0)]
    wanted = np.linalg.norm(segment, axis=1) * params.frequency / height * bears
    count = np.floor(wanted + random.random(len(parent))).astype(int)
    before = sum_before(parent, count)  # the spiral goes on over the nodes
    node = np.repeat(np.arange(len(parent)), count)
    number = np.arange(len(node)) - np.repeat(np.cumsum(count) - count, count) + before[node]
    axis = unit(segment[node])
    first, second = side_axes(axis)
    turn = np.radians(number * params.divergence + random.normal(0.0, 12.0, len(node)))[:, None]
    lean = np.radians(params.angle * random.uniform(0.7, 1.2, len(node)))[:, None]
    along = np.cos(lean) * axis + np.sin(lean) * (np.cos(turn) * first + np.sin(turn) * second)
    level = unit(along * np.array([1.0, 1.0 - params.plagiotropism, 1.0]))
    along = np.where(level.any(axis=1, keepdims=True), level, along)  # what stands upright bends nowhere
    over, aside = side_axes(along)
    length = mean_length * random.uniform(0.55, 1.3, len(node))
    shape = shapes.points[random.integers(0, _SHAPES, len(node))] * length[:, None, None]
    points = shape @ np.stack([-aside, along, over], axis=1)
    points[..., 1] -= (1.0 - params.rigidity) * shape[..., 1] ** 2 / length[:, None]
    radius = np.minimum(params.radius * height, _SLIMMER * skeleton.radius[node])
    return _Twigs(node, points + skeleton.points[node, None], radius)


def _inside(points: NDArray[np.float64], volume: DensityVolume) -> NDArray[np.bool_]:
    """Whether points (m, 3) lie in voxels that are not empty."""
    voxel = np.floor((points - volume.origin) / volume.voxel).astype(int)
    last = np.array(volume.density.shape) - 1
    within = ((voxel >= 0) & (voxel <= last)).all(axis=1)
    return np.asarray(within & (volume.density[tuple(np.clip(voxel, 0, last).T)] > 0))


def _twig_depth(grid: PlaneGrid, skeleton: Skeleton, shapes: TwigShapes, twigs: _Twigs) -> sparse.csr_array:
    """Optical depth that each twig gives each cell of a view: (cells, m)."""
    count, nodes = len(twigs.node), len(shapes.parent)
    base = skeleton.points[twigs.node].astype(np.float64)[:, None]
    start = np.concatenate([base, twigs.points], axis=1)[:, shapes.parent + 1]
    radius = twigs.radius[:, None] * shapes.thickness
    which = np.repeat(np.arange(count), nodes)
    return segment_depth(
        grid, start.reshape(-1, 3), twigs.points.reshape(-1, 3), radius.ravel(), which, count
    )


def _append(skeleton: Skeleton, shapes: TwigShapes, twigs: _Twigs) -> Skeleton:
    """The skeleton with the twigs' nodes behind its own, in an order that keeps parents first."""
    count, nodes = len(twigs.node), len(shapes.parent)
    first = len(skeleton.parent) + np.arange(count)[:, None] * nodes
    own = np.where(shapes.parent >= 0, first + shapes.parent, twigs.node[:, None]).ravel()
    order, parent = parents_first(np.concatenate([skeleton.parent, own]))
    points = np.concatenate([skeleton.points, twigs.points.reshape(-1, 3).astype(np.float32)])
    radius = np.concatenate([skeleton.radius, (twigs.radius[:, None] * shapes.thickness).ravel()])
    particles = np.concatenate([skeleton.particles, np.ones(count * nodes, np.int32)])
    return Skeleton(
        parent=parent,
        points=points[order],
        radius=radius[order].astype(np.float32),
        particles=particles[order],
        level=order_branches(parent, radius[order]),
        twig=np.concatenate([skeleton.twig, np.ones(count * nodes, np.bool_)])[order],
    )
