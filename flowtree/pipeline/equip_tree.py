"""A finished tree made ready for an engine."""

from __future__ import annotations

from dataclasses import replace

from flowtree.meshing.weld_thin_wood import THIN, weld_thin_wood
from flowtree.model.asset import TreeAsset
from flowtree.model.tree import TreeModel
from flowtree.params import Params
from flowtree.pipeline.build_asset import build_asset


def equip_tree(
    tree: TreeModel, *, params: Params = Params(), seed: int = 0, device: str | None = None
) -> TreeAsset:
    """Gives a tree the levels, cards, wind and solid bodies that the parameters ask for.

    Args:
        tree: with its skeleton.
        params: of which ``asset``, ``wind`` and ``collision`` count, and how the wood was meshed.
        seed: of all that is random.
        device: to run on; None picks.

    Raises:
        InputError: a budget too small for the trunk, or a tree that does not know its nodes.
    """
    asset = build_asset(tree, params.asset, seed, meshing=params.meshing, device=device)
    if params.asset.max_triangles:
        asset = replace(asset, levels=tuple(_lighter(level) for level in asset.levels))
    if params.wind.sway or params.wind.channels != "none":
        from flowtree.pipeline.build_wind import build_wind  # few ask for it

        asset = replace(asset, winds=build_wind(asset.levels, params.wind, seed))
    if params.collision.engine != "none":
        from flowtree.collision.bound_tree import bound_tree  # as few

        wanted = params.collision
        bodies = bound_tree(tree.skeleton, tree.foliage, capsules=wanted.capsules, hull=wanted.hull)
        asset = replace(asset, collision=bodies)
    return asset


def _lighter(level: TreeModel) -> TreeModel:
    wood = weld_thin_wood(level.wood, level.skeleton, radius=THIN * level.height)
    return replace(level, wood=wood)
