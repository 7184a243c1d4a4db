"""What moves a finished tree in the wind."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flowtree import check
from flowtree.model.tree import TreeModel
from flowtree.model.wind import Armature, Wind, WindWeights
from flowtree.params import WindParams
from flowtree.wind.bind_joints import bind_joints
from flowtree.wind.follow_joints import follow_joints
from flowtree.wind.name_channels import name_channels
from flowtree.wind.skin_vertices import skin_vertices
from flowtree.wind.spread_over_leaves import spread_over_leaves
from flowtree.wind.spread_over_wood import spread_over_wood
from flowtree.wind.sway_joints import sway_joints
from flowtree.wind.weigh_wind import weigh_wind

_Channels = dict[str, NDArray[Any]]


def build_wind(
    levels: Sequence[TreeModel], params: WindParams = WindParams(), seed: int = 0
) -> tuple[Wind, ...]:
    """Weighs each level of a tree and gives its vertices what the parameters ask for.

    All levels share the finest one's joints and motion: they are the same arrays in every result.

    Args:
        levels: of one tree, the finest first; their wood knows its nodes.
        params: which channels, and whether there are joints.
        seed: of phases and gusts.

    Returns: one for each level; none where the parameters ask for nothing.

    Raises:
        InputError: wood that does not know its nodes.
    """
    if params.channels == "none" and not params.sway:
        return ()
    finest = levels[0]
    weights = [weigh_wind(tree.skeleton, height=finest.height, seed=seed) for tree in levels]
    armatures: list[Armature | None] = [None] * len(levels)
    sway = None
    if params.sway:
        bound = bind_joints(finest.skeleton, joints=params.joints)
        sway = sway_joints(bound, weights[0], strength=params.strength, seconds=params.seconds, seed=seed)
        armatures = [bound, *(follow_joints(bound, finest.skeleton, tree.skeleton) for tree in levels[1:])]
    return tuple(
        Wind(
            weights=weight,
            armature=armature,
            sway=sway,
            wood=_wood_channels(tree, weight, armature, params.channels),
            leaves=_leaf_channels(tree, weight, armature, params.channels),
        )
        for tree, weight, armature in zip(levels, weights, armatures, strict=True)
    )


def _wood_channels(
    tree: TreeModel, weights: WindWeights, armature: Armature | None, layout: str
) -> _Channels:
    channels: _Channels = {}
    if layout != "none":
        channels |= name_channels(spread_over_wood(tree.skeleton, weights, tree.wood), layout)
    if armature is not None:
        node = tree.wood.node
        if node is None:
            check.fail("wood", "must know the node of each vertex", "none", "mesh it from the skeleton")
        joints, shares = skin_vertices(tree.skeleton, armature, node, tree.wood.positions)
        channels |= {"JOINTS_0": joints, "WEIGHTS_0": shares}
    return channels


def _leaf_channels(
    tree: TreeModel, weights: WindWeights, armature: Armature | None, layout: str
) -> _Channels:
    channels: _Channels = {}
    if tree.foliage is None:
        return channels
    if layout != "none":
        channels |= name_channels(spread_over_leaves(tree.skeleton, weights, tree.foliage), layout)
    if armature is not None:
        corners = len(tree.foliage.leaf.positions)
        joints, shares = skin_vertices(tree.skeleton, armature, tree.foliage.node, tree.foliage.position)
        channels["JOINTS_0"] = np.repeat(joints, corners, axis=0)
        channels["WEIGHTS_0"] = np.repeat(shares, corners, axis=0)
    return channels
