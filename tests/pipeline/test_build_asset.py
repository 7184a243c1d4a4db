from __future__ import annotations

import pytest

from flowtree.errors import InputError
from flowtree.export.check_asset import check_asset
from flowtree.params import AssetParams
from flowtree.pipeline.build_asset import build_asset
from tests.levels.trees import crowned_tree

TREE = crowned_tree(2, limbs=8, leaves=150)


def test_a_tree_alone_is_one_level():
    asset = build_asset(TREE)
    assert asset.levels == (TREE,)
    assert asset.cards == ()
    check_asset(asset)


@pytest.mark.parametrize(("kind", "frames"), [("crossed", 1), ("octahedral", 3)])
def test_levels_and_cards(kind, frames):
    params = AssetParams(max_triangles=2000, levels=3, impostor=kind, impostor_size=96, impostor_frames=3)
    asset = build_asset(TREE, params, 1, device="cpu")
    assert len(asset.levels) == 3
    (card,) = asset.cards
    assert card.name == kind
    assert card.frames == frames
    assert max(card.material.base_color.shape[:2]) <= 96
    check_asset(asset)


def test_pictures_too_small_are_an_error():
    with pytest.raises(InputError, match="impostor: needs 2 pictures"):
        build_asset(TREE, AssetParams(impostor="octahedral", impostor_size=64, impostor_frames=32))
