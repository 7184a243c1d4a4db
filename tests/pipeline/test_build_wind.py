from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from flowtree.errors import InputError
from flowtree.meshing.sweep_rings import sweep_rings
from flowtree.model.tree import TreeModel
from flowtree.params import MeshingParams, WindParams
from flowtree.pipeline.build_wind import build_wind
from flowtree.wind.name_channels import LAYOUTS
from tests.skeletons import random_skeleton
from tests.trees import bark_material, scatter_leaves
from tests.wind.test_weigh_wind import thin_out


def grown(leaves: int = 40, sides: int = 8) -> TreeModel:
    skeleton = random_skeleton(3, 80)
    return TreeModel(
        name="Oak",
        height=10.0,
        skeleton=skeleton,
        wood=sweep_rings(skeleton, params=MeshingParams(sides=sides)),
        bark=bark_material(),
        foliage=scatter_leaves(skeleton, leaves) if leaves else None,
    )


def test_nothing_is_made_unless_asked_for():
    assert build_wind([grown()], WindParams()) == ()


@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("sway", [False, True])
def test_every_vertex_carries_what_was_asked_for(layout, sway):
    tree = grown()
    (wind,) = build_wind([tree], WindParams(channels=layout, sway=sway))
    assert tree.foliage is not None
    for channels, count in (
        (wind.wood, len(tree.wood.positions)),
        (wind.leaves, 40 * len(tree.foliage.leaf.positions)),
    ):
        assert {len(values) for values in channels.values()} == {count}
        assert ("JOINTS_0" in channels) == ("WEIGHTS_0" in channels) == sway
        assert len(channels) > 2 * sway
    assert (wind.armature is not None) == (wind.sway is not None) == sway


def test_all_levels_share_joints_and_motion():
    levels = [grown(40, 8), grown(20, 4), grown(0, 4)]
    first, *others = build_wind(levels, WindParams(channels="none", sway=True))
    assert first.armature is not None
    for level, wind in zip(levels[1:], others, strict=True):
        assert wind.armature is not None
        assert wind.armature.points is first.armature.points
        assert wind.sway is first.sway
        assert len(wind.wood["JOINTS_0"]) == len(level.wood.positions)
    assert others[1].leaves == {}


def test_levels_swing_as_the_finest_where_they_kept_its_nodes():
    tree = grown()
    keep = np.isin(np.arange(80), tree.skeleton.parent)
    thinned = thin_out(tree.skeleton, keep)
    coarse = dataclasses.replace(tree, skeleton=thinned, wood=sweep_rings(thinned), foliage=None)
    first, second = build_wind([tree, coarse], WindParams(channels="attributes", sway=True))
    for name in ("depth", "pivot", "extent", "phase"):
        np.testing.assert_array_equal(getattr(second.weights, name), getattr(first.weights, name)[keep])
    assert first.armature is not None
    assert second.armature is not None
    np.testing.assert_array_equal(second.armature.joint, first.armature.joint[keep])


def test_the_same_seed_gives_the_same_bytes():
    params = WindParams(channels="attributes", sway=True)
    one, two = (build_wind([grown()], params, seed=4)[0] for _ in range(2))
    for part in ("wood", "leaves"):
        for name, values in getattr(one, part).items():
            assert values.tobytes() == getattr(two, part)[name].tobytes()
    assert one.sway is not None
    assert two.sway is not None
    assert one.sway.rotation.tobytes() == two.sway.rotation.tobytes()


def test_wood_that_does_not_know_its_nodes_is_refused():
    tree = grown()
    blind = dataclasses.replace(tree, wood=dataclasses.replace(tree.wood, node=None))
    for params in (WindParams(channels="attributes"), WindParams(sway=True)):
        with pytest.raises(InputError, match="node of each vertex"):
            build_wind([blind], params)
    assert np.isfinite(build_wind([tree], WindParams(sway=True))[0].weights.extent).all()
