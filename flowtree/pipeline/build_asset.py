"""A finished tree with all that an engine wants of it."""

from __future__ import annotations

from flowtree.levels.limit_textures import limit_textures
from flowtree.model.asset import Card, TreeAsset
from flowtree.model.tree import TreeModel
from flowtree.params import AssetParams, MeshingParams
from flowtree.pipeline.build_levels import build_levels


def build_asset(
    tree: TreeModel,
    params: AssetParams = AssetParams(),
    seed: int = 0,
    *,
    meshing: MeshingParams = MeshingParams(),
    device: str | None = None,
) -> TreeAsset:
    """Makes levels of detail within the budget, and an impostor of the finest of them.

    Args:
        tree: with its skeleton.
        params: how many triangles and levels, which textures, which cards.
        seed: of all that is random.
        meshing: how the tree's wood was made.
        device: to run on.

    Raises:
        InputError: a budget too small for the trunk, or pictures too small for anything.
    """
    levels = build_levels(
        tree,
        max_triangles=params.max_triangles,
        count=params.levels,
        meshing=meshing,
        seed=seed,
        device=device,
    )
    levels = limit_textures(levels, params.texture_size)
    cards = () if params.impostor == "none" else (_bake(levels[0], params, device),)
    if params.atlas:
        from flowtree.levels.pack_atlas import pack_atlas  # few ask for it

        levels = pack_atlas(levels)
    return TreeAsset(levels=levels, cards=cards)


def _bake(tree: TreeModel, params: AssetParams, device: str | None) -> Card:
    from flowtree.render.bake_crossed import bake_crossed  # few ask for either
    from flowtree.render.bake_octahedral import bake_octahedral

    size = params.impostor_size
    if params.impostor == "crossed":
        return bake_crossed(tree, cards=params.impostor_cards, size=size, device=device)
    return bake_octahedral(tree, size=size, frames=params.impostor_frames, device=device)
