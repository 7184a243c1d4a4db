"""Blender reads our GLB and USD files as they are meant."""

from __future__ import annotations

import importlib.util
from typing import Any

import numpy as np
import pytest

from flowtree.export.export_tree import export_tree
from flowtree.export.merge_leaves import merge_leaves
from flowtree.model.asset import TreeAsset
from flowtree.params import ExportParams
from tests.assets import equipped, levelled, meshed_tree
from tests.clients.blender import load_in_blender
from tests.trees import bare_tree

_FILES: dict[str, tuple[Any, ExportParams]] = {
    "plain.glb": (meshed_tree(), ExportParams()),
    "bare.glb": (bare_tree(), ExportParams()),
    "levels.glb": (levelled(), ExportParams()),
    "all.glb": (equipped(), ExportParams()),
    "small.glb": (equipped(), ExportParams(quantise=True)),
    "godot.glb": (equipped("godot", sway=False), ExportParams()),
    "instanced.glb": (meshed_tree(), ExportParams(instanced=True)),
    "plain.usdc": (meshed_tree(), ExportParams()),
    "levels.usdz": (levelled(), ExportParams()),
}


@pytest.fixture(scope="module")
def loaded(tmp_path_factory) -> dict[str, dict[str, Any]]:
    if importlib.util.find_spec("pxr") is None:
        pytest.skip("usd-core is not installed")
    folder = tmp_path_factory.mktemp("blender")
    paths = [folder / name for name in _FILES]
    for path, (tree, params) in zip(paths, _FILES.values(), strict=True):
        export_tree(tree, path, params=params)
    return dict(zip(_FILES, load_in_blender(*paths), strict=True))


def finest(name: str):
    tree = _FILES[name][0]
    return tree.levels[0] if isinstance(tree, TreeAsset) else tree


def is_body(name: str) -> bool:
    return "-convcolonly" in name


@pytest.mark.parametrize("name", _FILES)
def test_blender_counts_the_same_triangles(loaded, name):
    tree = finest(name)
    leaves = 0
    if tree.foliage is not None:
        leaves = len(tree.foliage.position) * len(tree.foliage.leaf.triangles)
    seen = {part: count for part, count in loaded[name]["meshes"].items() if not is_body(part)}
    assert sum(seen.values()) == len(tree.wood.triangles) + leaves


@pytest.mark.parametrize(
    "name", [name for name in _FILES if name not in ("all.glb", "small.glb", "godot.glb")]
)
def test_blender_places_it_alike(loaded, name):
    tree = finest(name)
    every = [tree.wood.positions]
    if tree.foliage is not None:
        every.append(merge_leaves(tree.foliage).positions)
    x, y, z = np.concatenate(every).T
    turned = np.stack([x, -z, y], axis=1)  # Blender's z points up
    # Half quaternions in USD turn a leaf by up to a tenth of a degree.
    np.testing.assert_allclose(
        loaded[name]["bounds"], [turned.min(axis=0), turned.max(axis=0)], atol=1e-3 if "usd" in name else 1e-5
    )


def test_joints_motion_wind_and_bodies_arrive(loaded):
    for name in ("all.glb", "small.glb"):
        report = loaded[name]
        wind = _FILES[name][0].winds[0]
        assert report["bones"] == len(wind.armature.parent)
        assert report["actions"] == ["sway"]
        assert set(report["attributes"]) == {key for key in wind.wood if key.startswith("_")}
        bodies = [part for part in report["meshes"] if is_body(part)]
        assert len(bodies) == len(_FILES[name][0].collision.capsule_radius) + 1
    assert loaded["plain.glb"]["materials"] == ["bark", "leaf"]


def test_the_names_are_there(loaded):
    assert set(loaded["plain.glb"]["meshes"]) == {"Oak_wood", "Oak_leaves"}
    assert set(loaded["levels.glb"]["meshes"]) == {"Oak_LOD0_wood", "Oak_LOD0_leaves"}
