"""Other programs read our GLB files as they are meant: gltf-validator, three.js and trimesh."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest
import trimesh

from flowtree.configuration import override_params
from flowtree.export.merge_leaves import merge_leaves
from flowtree.export.write_glb import write_glb
from flowtree.levels.pack_atlas import pack_atlas
from flowtree.model.asset import TreeAsset
from flowtree.model.mesh import TreeMesh
from flowtree.model.tree import TreeModel
from flowtree.params import Params
from flowtree.pipeline.equip_tree import equip_tree
from tests.assets import equipped, levelled, meshed_tree
from tests.clients.node import load_in_three, validate_glb
from tests.levels.trees import crowned_tree
from tests.trees import bare_tree, hand_made_tree, unusual_tree


def forest() -> list[TreeModel]:
    leafy = hand_made_tree()
    crowded = hand_made_tree(20_000, name="Crowded")  # more vertices than 16 bits count
    assert crowded.foliage is not None
    white = dataclasses.replace(crowded.foliage, color=np.zeros_like(crowded.foliage.color))
    nothing = TreeMesh(*(np.zeros((0, k), np.float32) for k in (3, 3, 2)), np.zeros((0, 3), np.int32))
    return [
        leafy,
        bare_tree(),
        unusual_tree(),
        dataclasses.replace(crowded, foliage=white),
        dataclasses.replace(leafy, name="Hedge", wood=nothing),
    ]


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> dict[Path, TreeModel]:
    folder = tmp_path_factory.mktemp("glb")
    written = {folder / f"{tree.name}.glb": tree for tree in forest()}
    for path, tree in written.items():
        write_glb(tree, path)
    return written


def expected_meshes(tree: TreeModel) -> dict[str, TreeMesh]:
    meshes = {f"{tree.name}_wood": tree.wood}
    if tree.foliage is not None:
        meshes[f"{tree.name}_leaves"] = merge_leaves(tree.foliage)
    return {name: mesh for name, mesh in meshes.items() if len(mesh.triangles)}


def bounds_of(meshes: dict[str, TreeMesh]) -> list[np.ndarray]:
    every = np.concatenate([mesh.positions for mesh in meshes.values()])
    return [every.min(axis=0), every.max(axis=0)]


def test_the_validator_finds_no_error(files: dict[Path, TreeModel]) -> None:
    for tree, report in zip(files.values(), validate_glb(*files), strict=True):
        # The one warning it has is true of every normal map without tangents, and intended.
        codes = {message["code"] for message in report["issues"]["messages"] if message["severity"] == 1}
        assert codes <= {"MESH_PRIMITIVE_GENERATED_TANGENT_SPACE"}
        triangles = sum(len(mesh.triangles) for mesh in expected_meshes(tree).values())
        assert report["info"]["totalTriangleCount"] == triangles
        assert not report["info"].get("resources", [{}])[0].get("uri")


@pytest.mark.parametrize("quantise", [False, True], ids=["exact", "quantised"])
@pytest.mark.parametrize("engine", ["godot", "unreal", "unity"])
def test_the_validator_finds_nothing_wrong_with_all_there_is(
    tmp_path: Path, engine: str, quantise: bool
) -> None:
    layouts = ("attributes", "colors", engine)
    packed = TreeAsset(pack_atlas(levelled().levels))
    assets = {layout: equipped(layout) for layout in layouts} | {"levels": levelled(), "atlas": packed}
    for name, asset in assets.items():
        write_glb(asset, tmp_path / f"{name}.glb", quantise=quantise, engine=engine)
    write_glb(meshed_tree(), tmp_path / "instanced.glb", quantise=quantise, instanced=True)
    paths = sorted(tmp_path.iterdir())
    for path, report in zip(paths, validate_glb(*paths), strict=True):
        assert report["issues"]["numWarnings"] == 0, (path, report["issues"]["messages"][:3])
    assert len(paths) == len(assets) + 1


def test_the_validator_finds_nothing_wrong_with_the_levels_of_a_bare_tree(tmp_path: Path) -> None:
    asked = [
        *("asset.levels=4", "asset.max_triangles=30000", "asset.texture_size=512"),
        *("wind.sway=true", "wind.channels=attributes", "collision.engine=godot"),
    ]
    plain = equip_tree(crowned_tree(5, leaves=0), params=override_params(Params(), asked), device="cpu")
    atlas = dataclasses.replace(plain, levels=pack_atlas(plain.levels), winds=())
    paths = [tmp_path / "plain.glb", tmp_path / "atlas.glb"]
    for asset, path in zip((plain, atlas), paths, strict=True):
        far = asset.levels[3]
        assert far.foliage is not None
        assert (far.bark.base_color is far.foliage.material.base_color) == (asset is atlas)
        write_glb(asset, path)
    for path, report, loaded in zip(paths, validate_glb(*paths), load_in_three(*paths), strict=True):
        assert report["issues"]["numWarnings"] == 0, (path, report["issues"]["messages"][:3])
        assert loaded["meshes"]["Tree_LOD0_wood"]["triangles"] == len(plain.levels[0].wood.triangles)


def test_three_loads_the_same_tree(files: dict[Path, TreeModel]) -> None:
    for tree, loaded in zip(files.values(), load_in_three(*files), strict=True):
        meshes = expected_meshes(tree)
        assert {tree.name, *meshes} <= set(loaded["nodes"])
        assert {name: mesh["triangles"] for name, mesh in loaded["meshes"].items()} == {
            name: len(mesh.triangles) for name, mesh in meshes.items()
        }
        np.testing.assert_array_equal(np.array(loaded["bounds"], np.float32), bounds_of(meshes))


def test_three_sees_the_materials(files: dict[Path, TreeModel]) -> None:
    tree = next(iter(files.values()))
    meshes = load_in_three(next(iter(files)))[0]["meshes"]
    wood, leaves = meshes["Oak_wood"], meshes["Oak_leaves"]
    assert wood["map"] == [64, 64]
    assert wood["normalMap"] == [64, 64]
    assert not wood["doubleSided"]
    assert wood["metalness"] == leaves["metalness"] == 0
    assert leaves["map"] == [32, 32]
    assert leaves["doubleSided"]
    assert leaves["vertexColors"]
    assert leaves["alphaTest"] == 0.5
    assert tree.foliage is not None
    assert leaves["roughness"] == pytest.approx(tree.foliage.material.roughness)


def test_trimesh_loads_the_same_tree(files: dict[Path, TreeModel]) -> None:
    for path, tree in files.items():
        scene, meshes = trimesh.load_scene(path), expected_meshes(tree)
        assert {name: len(mesh.faces) for name, mesh in scene.geometry.items()} == {
            name: len(mesh.triangles) for name, mesh in meshes.items()
        }
        assert {tree.name, *meshes} <= set(scene.graph.nodes)
        np.testing.assert_array_equal(scene.bounds.astype(np.float32), bounds_of(meshes))
