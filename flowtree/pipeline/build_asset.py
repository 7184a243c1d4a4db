"""A finished tree with all that an engine wants of it."""

from __future__ import annotations

from flowtree.model.asset import TreeAsset
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
    """Makes levels of detail within the budget.

    Args:
        tree: with its skeleton.
        params: how many triangles, levels and cards.
        seed: of all that is random.
        meshing: how the tree's wood was made.
        device: to run on.

    Raises:
        InputError: a budget too small for the trunk.
    """
    levels = build_levels(
        tree,
        max_triangles=params.max_triangles,
        count=params.levels,
        meshing=meshing,
        seed=seed,
        device=device,
    )
    return TreeAsset(levels=levels)
