"""A finished tree with all that an engine wants of it."""

from __future__ import annotations

from flowtree.levels.limit_textures import limit_textures
from flowtree.levels.pack_atlas import pack_atlas
from flowtree.model.asset import Card, TreeAsset
from flowtree.model.tree import TreeModel
from flowtree.params import AssetParams, MeshingParams
from flowtree.pipeline.build_levels import build_levels
from flowtree.render.bake_impostor import bake_crossed, bake_octahedral


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
    cards: tuple[Card, ...] = ()
    if params.impostor == "crossed":
        cards = (bake_crossed(levels[0], size=params.impostor_size, device=device),)
    elif params.impostor == "octahedral":
        size, frames = params.impostor_size, params.impostor_frames
        cards = (bake_octahedral(levels[0], size=size, frames=frames, device=device),)
    return TreeAsset(levels=pack_atlas(levels) if params.atlas else levels, cards=cards)
