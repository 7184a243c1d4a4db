"""Twigs by rule alone, for a skeleton without photographs (Particle Flows, section 8)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flowtree.branches.find_twig_places import append_twigs, find_twig_places
from flowtree.branches.shape_twigs import TwigShapes, shape_twigs
from flowtree.geometry.parent_array import sum_before
from flowtree.geometry.shadow_area import shadow_area
from flowtree.model.skeleton import Skeleton
from flowtree.params import TwigParams

_SHAPES = 16  # different twigs; more would not be told apart
_FULL = 0.4  # area, in squared heights, of a crown that is given all twigs
_CELL = 1.5  # twig lengths, of the cells by which that area is measured
_THIN = 0.3  # of the trunk's radius: thicker branches bear no twigs
_BARE = 2.0  # times as many twigs on a bare tree, where each is seen
_SPARSE = 4.0  # of the twigs that are wanted, one a length of branch is as dense as looks natural
_SHOOT = 2.6  # twig lengths, of the branchlets that a coarse skeleton lacks
_SHOOT_TWIGS = 4  # side branchlets on each


def sprout_twigs(
    skeleton: Skeleton,
    *,
    height: float | None = None,
    leafy: bool = True,
    shapes: TwigShapes | None = None,
    params: TwigParams = TwigParams(),
    seed: int = 0,
) -> Skeleton:
    """Adds twigs to the thin branches of any skeleton, evenly along them.

    The paper's "parameterized approach": length, frequency, rigidity, Golden Section rule and plagiotropism.
    How many there are goes by how large the crown looks from the side, up to ``params.most``. A coarse
    skeleton (a few limbs drawn or measured) has too little branch for them: it is first given branchlets,
    longer shoots that bear the twigs.

    Args:
        skeleton: branches with radii.
        height: of the tree [m]; None takes that of its highest node.
        leafy: whether the tree is to bear leaves; if not, twigs are longer, more and have side twigs.
        shapes: of the twigs, as `copy_twig` makes them of a drawn one; None for the usual shoots.
        params: length, angle, frequency and so on.
        seed: of the places and bends.

    Returns: the skeleton with the twigs' nodes, marked in ``twig``; the same where nothing can bear any.
    """
    height = height or float(np.ptp(skeleton.points[:, 1]))
    bears = _thin(skeleton, params)
    if not bears.any() or params.most == 0 or params.frequency == 0.0 or height <= 0.0:
        return skeleton
    random = np.random.default_rng(seed)
    length = height * (params.length if leafy else params.bare_length)
    crown = shadow_area(skeleton.points[bears], _CELL * length)
    wanted = params.most * min(crown / (_FULL * height**2), 1.0) * (1.0 if leafy else _BARE)

    def sprout(
        bearing: Skeleton, on: NDArray[np.bool_], kinds: TwigShapes, long: float, most: float
    ) -> Skeleton:
        way = float(_way(bearing)[on].sum())
        places = find_twig_places(
            bearing,
            kinds,
            bears=on,
            frequency=min(most / max(way, 1e-9), params.frequency / height),
            length=long,
            height=height,
            params=params,
            seed=seed,
        )
        return append_twigs(bearing, kinds, places) if len(places.node) else bearing

    made = skeleton
    if float(_way(skeleton)[bears].sum()) < wanted * length / _SPARSE:
        shoots = shape_twigs(
            _SHAPES, side_twigs=_SHOOT_TWIGS, angle=params.angle, curl=params.curl, random=random
        )
        made = sprout(skeleton, bears, shoots, _SHOOT * length, wanted / (2 * _SHOOT * _SPARSE))
        bears = _thin(made, params) | made.twig
    if shapes is None:
        shapes = shape_twigs(
            _SHAPES,
            side_twigs=0 if leafy else params.side_twigs,
            angle=params.angle,
            curl=params.curl,
            random=random,
        )
    return sprout(made, bears, shapes, length, wanted)


def _thin(skeleton: Skeleton, params: TwigParams) -> NDArray[np.bool_]:
    """(n,) which nodes' segments bear twigs: thin ones, of few particles or tips; of none the outer ones."""
    branch = (skeleton.parent >= 0) & ~skeleton.twig & (skeleton.particles <= params.bearing_particles)
    thin = branch & (skeleton.radius <= _THIN * skeleton.radius[0])
    if thin.any():
        return np.asarray(thin)
    # A stem and a few limbs without taper: their outer halves, as far as the way from the foot goes.
    way = sum_before(skeleton.parent, _way(skeleton)) + _way(skeleton)
    return np.asarray(branch & (way > 0.5 * way.max()))


def _way(skeleton: Skeleton) -> NDArray[np.float64]:
    """Length of each node's segment [m]."""
    ends = skeleton.points.astype(np.float64)
    return np.asarray(np.linalg.norm(ends - ends[np.maximum(skeleton.parent, 0)], axis=1))
