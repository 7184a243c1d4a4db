"""Turns thin branches to where the mattes show the tree."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sparse
from numpy.typing import NDArray

from flowtree.branches.draw_poses import draw_poses
from flowtree.device import side_by_side
from flowtree.geometry.choose_cover import choose_poses
from flowtree.geometry.cover_canvas import CELLS, CoverCanvas, lay_canvas, lay_guess, rod_radii
from flowtree.geometry.find_painted import find_directed
from flowtree.geometry.footprint_means import optical_depth
from flowtree.geometry.parent_array import levels
from flowtree.geometry.place_chance import place_chance
from flowtree.geometry.place_code import place_code
from flowtree.model.camera import Camera
from flowtree.model.edit import PaintedEdit
from flowtree.model.guessed_view import GuessedView
from flowtree.model.matte import Matte
from flowtree.model.skeleton import Skeleton
from flowtree.model.volume import DensityVolume
from flowtree.params import TwigParams

# Particles of what is turned as one, at most: first sprays, then what they are made of.
_SIZES = (16, 8, 4, 2, 1)
_LEAFY_SIZES = (2,)  # leaves hide the rest
_POSES = 8
_THINNEST = 0.5  # radius to that of the thinnest branch, at least
_CONTENTED = 0.8  # share of the best pose's merit with which a branch stays as the flow left it
_THICKEST = 2.5  # factor to the radius of thin branches at most
_DENSEST = 2.5  # optical depth that twigs alone can have
_SIDE = 0.4  # length of a side twig to its twig's
_SLIM = 0.5  # of a twig's width at its base, what is seen of it from a random side, tips and all
_STEPS = 4  # of the thickness, to each doubling: a bit of a matte must not change all branches
_BATCHES = 8


def turn_twigs(
    skeleton: Skeleton,
    volume: DensityVolume,
    mattes: Sequence[Matte],
    cameras: Sequence[Camera],
    *,
    height: float,
    between: Sequence[GuessedView] = (),
    leafy: bool = False,
    edits: Sequence[PaintedEdit] = (),
    params: TwigParams = TwigParams(),
    seed: int = 0,
) -> Skeleton:
    """Turns, stretches, thins or drops thin branches until the wood comes near each matte's alpha.

    The paper leaves the branches where the particles ran; the flow knows the crown's density in voxels, and
    of a bare tree the mattes show every branch. Sprays of few particles may turn a little about the fork that
    they grow from, first large ones as a whole, then the small ones that they are made of. Several poses of
    each are drawn (see `draw_poses`), and `choose_poses` takes those with which the alpha of all wood comes
    nearest to the mattes'. A spray that does well where it is stays there; one that does harm in every pose
    goes.

    Of a bare tree, where the mattes show more wood than the branches and all twigs aimed at have, thin
    branches are thickened before: they bear the twigs, and no twig is thicker than its branch. On a leafy
    tree, whose wood the mattes hardly show, only the last branches are turned, out of the gaps of the crown
    to where leaves are wanted.

    Args:
        skeleton: branches with radii.
        volume: of poses that look alike those in dense voxels are taken.
        mattes: one a view.
        cameras: theirs.
        height: of the tree [m].
        between: the volume from where no photograph looks: there the wood comes near its alpha.
        leafy: whether the tree bears leaves.
        edits: one a view, or none: branches to which a person gave a direction are not turned.
        params: how far a spray may turn; number and size of the twigs.
        seed: of the poses.

    Returns: the skeleton with moved nodes, without those of dropped sprays.
    """
    if not leafy:
        skeleton = _thicken(skeleton, mattes, cameras, height, params)
    thinnest = _THINNEST * float(skeleton.radius.min())
    for size in (_LEAFY_SIZES if leafy else _SIZES) if params.turn > 0.0 else ():
        given = find_directed(skeleton.points, cameras[: len(edits)], edits)
        skeleton = _turn_sprays(
            skeleton,
            _find_sprays(skeleton, size, given),
            volume,
            mattes,
            cameras,
            between,
            height,
            thinnest=thinnest,
            spread=params.turn,
            seed=seed,
        )
    return skeleton


def _thicken(
    skeleton: Skeleton, mattes: Sequence[Matte], cameras: Sequence[Camera], height: float, params: TwigParams
) -> Skeleton:
    """Makes thin branches thicker, the thinnest most, where all twigs aimed at could not fill the mattes."""
    thin = skeleton.particles <= params.bearing_particles
    if params.most == 0 or not thin.any():
        return skeleton
    lacking = []
    for matte, camera in zip(mattes, cameras, strict=True):
        canvas = _lay(matte, camera, height).with_tree(skeleton.parent, skeleton.points, skeleton.radius)
        wanted, shown = (optical_depth(a.astype(np.float64)) for a in (canvas.wanted, canvas.shown()))
        room = np.minimum(wanted, _DENSEST) - shown
        lacking.append(float((np.maximum(room, 0.0) * canvas.known).sum()) * canvas.grid.cell**2)
    radius = min(params.radius * height, float(np.median(skeleton.radius[thin])))
    length = params.bare_length * height * (1.0 + _SIDE * params.side_twigs)
    factor = float(np.mean(lacking)) / (params.most * length * 2.0 * _SLIM * radius)
    factor = float(np.exp2(np.floor(_STEPS * np.log2(np.clip(factor, 1.0, _THICKEST))) / _STEPS))
    particles = np.maximum(skeleton.particles.astype(np.float64), 1.0)
    share = 1.0 - np.log(particles) / np.log(max(particles[0], 2.0))
    grown = skeleton.radius * factor**share
    for nodes in levels(skeleton.parent)[1:]:
        grown[nodes] = np.minimum(grown[nodes], grown[skeleton.parent[nodes]])
    return replace(skeleton, radius=grown.astype(np.float32))


def _lay(matte: Matte, camera: Camera, height: float) -> CoverCanvas:
    return lay_canvas(matte.alpha, matte.unknown, camera, cell=height / CELLS)


@dataclass(frozen=True)
class _Sprays:
    """What is turned, each spray's nodes one after the other.

    Attributes:
        node: (k,) nodes.
        spray: (k,) the spray that each belongs to, ascending.
        pivot: (m,) the node that each spray grows from.
    """

    node: NDArray[np.int64]
    spray: NDArray[np.int64]
    pivot: NDArray[np.int64]


def _turn_sprays(
    skeleton: Skeleton,
    sprays: _Sprays,
    volume: DensityVolume,
    mattes: Sequence[Matte],
    cameras: Sequence[Camera],
    between: Sequence[GuessedView],
    height: float,
    *,
    thinnest: float,
    spread: float,
    seed: int,
) -> Skeleton:
    """One round."""
    count = len(sprays.pivot)
    if not count:
        return skeleton
    parent, points = skeleton.parent, skeleton.points.astype(np.float64)
    first = np.searchsorted(sprays.spray, np.arange(count))
    code = place_code(points[sprays.node[first]], height)
    pivot = points[sprays.pivot]
    rods = [points[parent[sprays.node]] - pivot[sprays.spray], points[sprays.node] - pivot[sprays.spray]]
    poses = draw_poses(rods[1], first, pivot, code, count=_POSES, spread=spread, volume=volume, seed=seed)
    radius = rod_radii(parent, skeleton.radius)[sprays.node]
    # Every spray's rods once a pose.
    each = np.diff(np.append(first, len(sprays.node)))
    sizes = np.repeat(each, _POSES)
    row = np.repeat(np.arange(count * _POSES), sizes)
    rod = np.arange(len(row)) - np.repeat(np.cumsum(sizes) - sizes, sizes) + np.repeat(first, _POSES * each)
    turned = poses.turn.reshape(-1, 3, 3)[row]
    wide = radius[rod] * poses.slim.ravel()[row]
    start, end = (np.einsum("nij,nj->ni", turned, r[rod]) + pivot[row // _POSES] for r in rods)
    still = np.ones(len(parent), np.bool_)
    still[sprays.node] = False
    rest = np.where(still, parent, -1)

    def stand(canvas: CoverCanvas) -> tuple[CoverCanvas, sparse.csr_array]:
        covers = canvas.rod_covers(start, end, wide, row, count * _POSES)
        return canvas.with_tree(rest, skeleton.points, skeleton.radius), covers

    laid = [_lay(matte, camera, height) for matte, camera in zip(mattes, cameras, strict=True)]
    laid += [lay_guess(view.alpha, view.camera, cell=height / CELLS, weight=view.weight) for view in between]
    canvases, covers = zip(*side_by_side(stand, laid), strict=True)
    batch = (_BATCHES * place_chance(code, seed, 0)).astype(np.int64)
    chosen = choose_poses(canvases, covers, poses=_POSES, batch=batch, contented=_CONTENTED)
    pose = np.arange(count), np.maximum(chosen, 0)
    points[sprays.node] = (
        np.einsum("nij,nj->ni", poses.turn[pose][sprays.spray], rods[1]) + pivot[sprays.spray]
    )
    still[sprays.node] = chosen[sprays.spray] >= 0
    own = skeleton.radius.copy()
    own[sprays.node] = np.maximum(own[sprays.node] * poses.slim[pose][sprays.spray], thinnest)
    return _without(replace(skeleton, points=points.astype(np.float32), radius=own), still)


def _find_sprays(skeleton: Skeleton, size: int, still: NDArray[np.bool_]) -> _Sprays:
    """The largest parts of the tree, each behind one fork, that hold at most ``size`` particles.

    Those with a node (n,) that is to be still are left out.
    """
    parent = skeleton.parent
    thin = (parent >= 0) & (skeleton.particles <= size)
    base = thin & ~thin[np.maximum(parent, 0)]
    pivot = parent[base].astype(np.int64)
    spray = np.full(len(parent), -1, np.int64)
    spray[base] = np.arange(len(pivot))
    for nodes in levels(parent)[1:]:
        inside = nodes[thin[nodes] & ~base[nodes]]
        spray[inside] = spray[parent[inside]]
    moves = np.bincount(spray[still & thin], minlength=len(pivot)) == 0
    pivot, number = pivot[moves], np.append(np.where(moves, np.cumsum(moves) - 1, -1), -1)
    spray = number[spray]
    node = np.flatnonzero(spray >= 0)
    node = node[np.argsort(spray[node], kind="stable")]
    return _Sprays(node, spray[node], pivot)


def _without(skeleton: Skeleton, kept: NDArray[np.bool_]) -> Skeleton:
    """The skeleton of the nodes that are kept; with a node all behind it must go."""
    index = np.cumsum(kept) - 1
    parent = np.where(skeleton.parent >= 0, index[np.maximum(skeleton.parent, 0)], -1)[kept]
    return Skeleton(
        parent=parent.astype(np.int32),
        points=skeleton.points[kept],
        radius=skeleton.radius[kept],
        particles=skeleton.particles[kept],
        level=skeleton.level[kept],
        twig=skeleton.twig[kept],
    )
