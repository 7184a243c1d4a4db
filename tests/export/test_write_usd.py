"""USD holds the tree, passes usd-core's own validation, and is the same every time."""

from __future__ import annotations

import dataclasses
import os
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from flowtree.errors import InputError, OutputError
from flowtree.export.inspect_file import inspect_file
from flowtree.export.merge_leaves import merge_leaves
from flowtree.export.write_usd import USD_ENDINGS, write_usd
from tests.assets import equipped, meshed_tree
from tests.trees import bare_tree, hand_made_tree, unusual_tree


@pytest.fixture(scope="module")
def pxr():
    try:
        from pxr import Usd, UsdGeom, UsdShade, UsdValidation
    except ImportError:
        pytest.skip("usd-core is not installed")
    return Usd, UsdGeom, UsdShade, UsdValidation


def bounds(pxr, stage) -> np.ndarray:
    _, geom, _, _ = pxr
    box = geom.BBoxCache(0, ["default", "render"]).ComputeWorldBound(stage.GetDefaultPrim())
    found = box.ComputeAlignedRange()
    return np.array([found.GetMin(), found.GetMax()])


def expected_bounds(tree) -> np.ndarray:
    every = [tree.wood.positions]
    if tree.foliage is not None:
        every.append(merge_leaves(tree.foliage).positions)
    every = np.concatenate(every)
    return np.array([every.min(axis=0), every.max(axis=0)])


@pytest.mark.parametrize("ending", USD_ENDINGS)
@pytest.mark.parametrize(
    "tree",
    [hand_made_tree(), bare_tree(), unusual_tree(), equipped()],
    ids=["leafy", "bare", "odd", "levels"],
)
def test_usd_core_finds_nothing_wrong(pxr, tmp_path, tree, ending):
    usd, _, _, validation = pxr
    path = tmp_path / f"oak{ending}"
    write_usd(tree, path)
    stage = usd.Stage.Open(str(path))
    registry = validation.ValidationRegistry()
    context = validation.ValidationContext(registry.GetOrLoadAllValidators())
    assert [(error.GetName(), error.GetMessage()) for error in context.Validate(stage)] == []
    assert (len(list(tmp_path.iterdir())) == 1) == (ending == ".usdz")


@pytest.mark.parametrize("tree", [hand_made_tree(), bare_tree()], ids=["leafy", "bare"])
def test_the_stage_holds_the_tree(pxr, tmp_path, tree):
    usd, geom, shade, _ = pxr
    write_usd(tree, tmp_path / "oak.usdc")
    stage = usd.Stage.Open(str(tmp_path / "oak.usdc"))
    assert geom.GetStageMetersPerUnit(stage) == 1.0
    assert geom.GetStageUpAxis(stage) == "Y"
    root = stage.GetDefaultPrim()
    assert root.GetName() == tree.name
    wood = geom.Mesh(root.GetChild("wood"))
    np.testing.assert_array_equal(np.array(wood.GetPointsAttr().Get()), tree.wood.positions)
    corners = np.array(wood.GetFaceVertexIndicesAttr().Get()).reshape(-1, 3)
    np.testing.assert_array_equal(corners, tree.wood.triangles)
    material, _ = shade.MaterialBindingAPI(wood.GetPrim()).ComputeBoundMaterial()
    assert material.ComputeSurfaceSource()[0].GetIdAttr().Get() == "UsdPreviewSurface"
    np.testing.assert_allclose(bounds(pxr, stage), expected_bounds(tree), atol=2e-3)
    leaves = root.GetChild("leaves")
    assert bool(leaves) == (tree.foliage is not None)
    if tree.foliage is not None:
        instancer = geom.PointInstancer(leaves)
        np.testing.assert_array_equal(np.array(instancer.GetPositionsAttr().Get()), tree.foliage.position)
        assert instancer.GetInstanceCount() == len(tree.foliage.position)


def test_levels_and_cards_are_variants(pxr, tmp_path):
    usd, geom, _, _ = pxr
    asset = equipped()
    write_usd(asset, tmp_path / "oak.usda")
    stage = usd.Stage.Open(str(tmp_path / "oak.usda"))
    root = stage.GetDefaultPrim()
    levels = root.GetVariantSets().GetVariantSet("LOD")
    assert levels.GetVariantNames() == ["LOD0", "LOD1", "LOD2", "LOD3"]
    assert levels.GetVariantSelection() == "LOD0"
    for k, level in enumerate(asset.levels):
        levels.SetVariantSelection(f"LOD{k}")
        instancer = geom.PointInstancer(root.GetChild("leaves"))
        assert instancer.GetInstanceCount() == len(level.foliage.position)
    # Three levels of one bark, whose leaves differ in their mean colour, and a card.
    assert len(list(tmp_path.glob("*_normal.jpg"))) == 1
    levels.SetVariantSelection("LOD3")
    assert not root.GetChild("wood")
    assert root.GetChild("card")


@pytest.mark.parametrize("ending", USD_ENDINGS)
def test_inspecting_says_what_was_put_in(pxr, tmp_path, ending):
    asset, path = equipped(), tmp_path / f"oak{ending}"
    write_usd(asset, path)
    found = inspect_file(path)
    expected = [
        len(level.wood.triangles) + len(level.foliage.position) * len(level.foliage.leaf.triangles)
        for level in asset.levels
    ]
    assert [level["triangles"] for level in found["levels"]] == [*expected, 4]
    assert found["triangles"] == expected[0]
    np.testing.assert_allclose(found["bounds"]["max"][1], 3.5, atol=1e-3)
    assert found["warnings"] == []
    path.write_bytes(b"nonsense")
    with pytest.raises(InputError, match="must be a well-formed file"):
        inspect_file(path)


@pytest.mark.parametrize("ending", USD_ENDINGS)
def test_the_same_tree_gives_the_same_bytes_whenever(tmp_path, monkeypatch, pxr, ending):
    kept = []
    for zone in ("UTC", "Asia/Tokyo"):
        monkeypatch.setenv("TZ", zone)
        time.tzset()
        write_usd(meshed_tree(), tmp_path / f"oak{ending}")
        kept.append({path.name: path.read_bytes() for path in tmp_path.iterdir()})
    monkeypatch.undo()
    time.tzset()
    assert kept[0] == kept[1]


def test_odd_names_become_names_that_usd_takes(pxr, tmp_path):
    usd = pxr[0]
    tree = dataclasses.replace(bare_tree(), name="7 Ölbäume / 木")
    write_usd(tree, tmp_path / "a b-ü.usda")
    assert usd.Stage.Open(str(tmp_path / "a b-ü.usda")).GetDefaultPrim().GetName().startswith("_7")


def test_without_usd_core_it_is_said_what_to_install(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "pxr", None)
    with pytest.raises(InputError, match=r"pip install 'flowtree-3d\[usd\]'"):
        write_usd(bare_tree(), tmp_path / "oak.usdc")


def test_a_folder_that_is_not_there_is_said(tmp_path, pxr):
    with pytest.raises(OutputError):
        write_usd(bare_tree(), Path(os.path.join(tmp_path, "missing", "oak.usdc")))
