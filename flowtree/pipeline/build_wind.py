"""What moves a finished tree in the wind."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flowtree import check
from flowtree.model.tree import TreeModel
from flowtree.model.wind import Armature, Wind, WindWeights
from flowtree.params import WindParams
from flowtree.wind.bind_joints import bind_joints
from flowtree.wind.match_nodes import match_nodes
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

    All levels swing as the finest one, so that nothing jumps where one gives way to the next: their nodes
    take its weights and joints. The joints and their motion are the same arrays in every result.

    Args:
        levels: of one tree, the finest first, their nodes where it has nodes; their wood knows its nodes.
        params: which channels, and whether there are joints.
        seed: of phases and gusts.

    Returns: one for each level; none where the parameters ask for nothing.

    Raises:
        InputError: wood that does not know its nodes.
    """
    if params.channels == "none" and not params.sway:
        return ()
    finest = levels[0].skeleton
    weights = weigh_wind(finest, height=levels[0].height, seed=seed)
    armature, sway = None, None
    if params.sway:
        armature = bind_joints(finest, joints=params.joints)
        sway = sway_joints(armature, weights, strength=params.strength, seconds=params.seconds, seed=seed)
    winds = []
    for tree in levels:
        own, bound = weights, armature
        if tree is not levels[0]:
            node = match_nodes(finest, tree.skeleton)
            own = WindWeights(
                depth=weights.depth[node],
                pivot=weights.pivot[node],
                extent=weights.extent[node],
                phase=weights.phase[node],
            )
            if armature is not None:
                bound = replace(armature, joint=armature.joint[node], weight=armature.weight[node])
        wood = _wood_channels(tree, own, bound, params.channels)
        winds.append(Wind(own, bound, sway, wood, _leaf_channels(tree, own, bound, params.channels)))
    return tuple(winds)


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
