"""Leaves by rule alone, for a skeleton without photographs (Particle Flows, section 8)."""

from __future__ import annotations

import numpy as np

from flowtree.foliage.find_leaf_places import FREE_STREAM, bearing_way, find_leaf_places
from flowtree.foliage.make_leaf import leaf_coverage
from flowtree.foliage.tint_leaves import tint_leaves
from flowtree.geometry.shadow_area import shadow_area
from flowtree.model.foliage import Foliage
from flowtree.model.mesh import Material, TreeMesh
from flowtree.model.skeleton import Skeleton
from flowtree.params import LeafParams

_DEPTH = 1.6  # mean optical depth of a crown
_FACING = 0.5  # mean of |cosine| between random leaves and a view
_CELL = 0.05  # of the height, of the cells by which the crown's area is measured


def scatter_leaves(
    skeleton: Skeleton,
    leaf: tuple[TreeMesh, Material],
    *,
    height: float | None = None,
    params: LeafParams = LeafParams(),
    seed: int = 0,
) -> Foliage | None:
    """Puts leaves on twigs and thin branches, evenly along them.

    The paper places leaves by the density of the voxels; where there is none, the Golden Section rule goes on
    at one rate: so many leaves that the crown looks as dense as a full one does, but no more than fit along
    the twigs. Where that would take more than ``params.most`` leaves, fewer and larger ones cover as much.

    Args:
        skeleton: with radii and twigs.
        leaf: what `make_leaf` gives.
        height: of the tree [m]; None takes that of its highest node.
        params: size, amount, angles, colour.
        seed: of all that is random.

    Returns: the leaves; None where nothing can bear any.

    Raises:
        InputError: ``params.color`` is no colour.
    """
    blade, material = leaf
    height = height or float(np.ptp(skeleton.points[:, 1]))
    way = bearing_way(skeleton, params)
    total = float(way.sum())
    if total <= 0.0 or params.amount == 0.0 or height <= 0.0:
        return None
    crown = shadow_area(skeleton.points[way > 0], _CELL * height)
    wanted = params.amount * _DEPTH / _FACING * crown / leaf_coverage(blade, material)
    length = max(params.size * height, float(np.sqrt(wanted / params.most)))
    rate = min(wanted / length**2 / total, params.densest / length)
    places = find_leaf_places(skeleton, rate=rate, length=length, height=height, params=params, seed=seed)
    if not len(places.node):
        return None
    return Foliage(
        leaf=blade,
        material=material,
        position=places.position.astype(np.float32),
        rotation=places.rotation.astype(np.float32),
        scale=places.length.astype(np.float32),
        color=tint_leaves(
            places.code,
            places.number + FREE_STREAM,
            shape=material.name.removeprefix("leaf_"),
            color=params.color,
            variation=params.color_variation,
            seed=seed,
        ),
        node=places.node.astype(np.int32),
        rounding=params.rounding,
    )
