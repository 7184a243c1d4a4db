"""A finished tree gets what the parameters ask for, and nothing else."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from flowtree.configuration import override_params
from flowtree.errors import InputError
from flowtree.params import Params
from flowtree.pipeline.equip_tree import equip_tree
from tests.pipeline.test_build_wind import grown


def params(*assignments: str) -> Params:
    return override_params(Params(), assignments)


def test_by_default_one_level_with_fewer_vertices_in_its_thin_wood():
    tree = dataclasses.replace(grown(), height=1000.0)  # for which its branches are thin
    asset = equip_tree(tree)
    (level,) = asset.levels
    assert (asset.cards, asset.winds, asset.collision) == ((), (), None)
    assert len(level.wood.positions) < len(tree.wood.positions)
    np.testing.assert_array_equal(
        level.wood.positions[level.wood.triangles], tree.wood.positions[tree.wood.triangles]
    )


def test_without_a_budget_the_tree_stays_as_it_is():
    tree = grown()
    assert equip_tree(tree, params=params("asset.max_triangles=0")).levels == (tree,)


def test_everything_fits_together():
    wanted = params(
        *("asset.levels=3", "asset.max_triangles=1500", "asset.impostor=crossed", "asset.impostor_size=128"),
        *("wind.channels=attributes", "wind.sway=true", "wind.joints=12", "collision.engine=godot"),
    )
    asset = equip_tree(grown(), params=wanted)
    assert len(asset.levels) == len(asset.winds) == 3
    assert len(asset.cards) == 1
    assert asset.collision is not None
    for level, wind in zip(asset.levels, asset.winds, strict=True):
        assert {len(values) for values in wind.wood.values()} == {len(level.wood.positions)}
        assert wind.armature is not None
        assert len(wind.armature.parent) <= 12


def test_a_budget_below_the_trunk_is_refused():
    with pytest.raises(InputError, match="max_triangles"):
        equip_tree(grown(0), params=params("asset.max_triangles=3"))
