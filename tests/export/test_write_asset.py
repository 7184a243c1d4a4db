"""Levels, cards, skins, wind, bodies, instances and fewer bits: all of it decodes to what went in."""

from __future__ import annotations

import dataclasses
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.errors import InputError
from flowtree.export.export_tree import export_tree
from flowtree.export.inspect_file import inspect_file
from flowtree.export.merge_leaves import merge_leaves
from flowtree.export.read_glb import read_glb
from flowtree.export.write_glb import encode_glb
from flowtree.model.asset import TreeAsset
from flowtree.params import ExportParams
from tests.assets import equipped, levelled, meshed_tree
from tests.export.test_write_glb import decode, take_apart


def by_name(document, kind="nodes"):
    return {entry["name"]: entry for entry in document[kind]}


def triangles(tree) -> int:
    return len(tree.wood.triangles) + len(tree.foliage.position) * len(tree.foliage.leaf.triangles)


@pytest.mark.parametrize("quantise", [False, True])
def test_the_same_asset_gives_the_same_bytes(quantise):
    assert encode_glb(equipped(), quantise=quantise) == encode_glb(equipped(), quantise=quantise)


def test_another_process_gives_the_same_bytes():
    code = (
        "import hashlib\nfrom tests.assets import equipped\n"
        "from flowtree.export.write_glb import encode_glb\n"
        "print(hashlib.sha256(encode_glb(equipped())).hexdigest())"
    )
    root = Path(__file__).parents[2]
    prints = [
        subprocess.run(
            [sys.executable, "-c", code], cwd=root, capture_output=True, text=True, check=True
        ).stdout
        for _ in range(2)
    ]
    assert prints[0] == prints[1]
    assert len(prints[0]) == 65


def test_level_0_is_shown_and_names_the_others():
    document, _ = take_apart(encode_glb(levelled()))
    nodes, index = by_name(document), [node["name"] for node in document["nodes"]]
    assert [index[child] for child in nodes["Oak"]["children"]] == ["Oak_LOD0"]
    assert [index[child] for child in nodes["Oak_LOD1"]["children"]] == ["Oak_LOD1_wood", "Oak_LOD1_leaves"]
    others = nodes["Oak_LOD0"]["extensions"]["MSFT_lod"]["ids"]
    assert [index[node] for node in others] == ["Oak_LOD1", "Oak_LOD2", "Oak_LOD3"]
    ends = nodes["Oak_LOD0"]["extras"]["MSFT_screencoverage"]
    assert ends == sorted(ends, reverse=True)
    assert len(ends) == 4
    assert [[index[node] for node in scene["nodes"]] for scene in document["scenes"]] == [
        ["Oak"],
        ["Oak_LOD1"],
        ["Oak_LOD2"],
        ["Oak_LOD3"],
    ]
    assert [image["name"] for image in document["images"]] == ["bark", "bark_normal", "leaf", "card"]
    assert nodes["Oak_LOD3"]["extras"] == {"impostor": "crossed", "frames": 1}


@pytest.mark.parametrize("asset", [levelled(), equipped()], ids=["levels", "skinned"])
def test_a_card_that_needs_a_shader_is_no_level_for_everybody(asset):
    asset = dataclasses.replace(asset, cards=(dataclasses.replace(asset.cards[0], frames=8),))
    document, _ = take_apart(encode_glb(asset))
    card = [node["name"] for node in document["nodes"]].index("Oak_LOD3")
    linked = [
        node
        for each in document["nodes"]
        for node in each.get("extensions", {}).get("MSFT_lod", {}).get("ids", [])
    ]
    assert linked
    assert card not in linked
    assert document["scenes"][3]["nodes"] == [card]


def test_joints_stand_and_turn_as_they_should():
    asset = equipped()
    document, buffer = take_apart(encode_glb(asset))
    armature, sway = asset.winds[0].armature, asset.winds[0].sway
    (skin,), (motion,) = document["skins"], document["animations"]
    joints = [document["nodes"][node] for node in skin["joints"]]
    parent = {child: node for node in skin["joints"] for child in document["nodes"][node].get("children", [])}
    for k, node in enumerate(skin["joints"]):
        place, up = np.array(joints[k]["translation"]), node
        while up in parent:
            up = parent[up]
            place = place + document["nodes"][up]["translation"]
        np.testing.assert_allclose(place, armature.points[k], atol=1e-6)
        undo = decode(document, buffer, skin["inverseBindMatrices"])[k].reshape(4, 4).T
        np.testing.assert_allclose(undo[:3, 3], -armature.points[k], atol=1e-6)
    assert motion["name"] == sway.name
    for channel in motion["channels"]:
        sampler = motion["samplers"][channel["sampler"]]
        np.testing.assert_array_equal(decode(document, buffer, sampler["input"])[:, 0], sway.times)
        turns = decode(document, buffer, sampler["output"])
        np.testing.assert_allclose(
            turns, sway.rotation[:, skin["joints"].index(channel["target"]["node"])], atol=1e-4
        )
    # Skinned meshes are roots of their scene, and their nodes place nothing.
    index = [node["name"] for node in document["nodes"]]
    for scene, level in zip(document["scenes"][:3], range(3), strict=True):
        names = [index[node] for node in scene["nodes"]]
        assert names == ["Oak", f"Oak_LOD{level}_wood", f"Oak_LOD{level}_leaves"]
    for node in document["nodes"]:
        assert ("skin" in node) <= ("translation" not in node and "scale" not in node)


def test_wind_attributes_arrive_for_every_vertex():
    asset = equipped()
    document, buffer = take_apart(encode_glb(asset))
    for part in ("wood", "leaves"):
        mesh = document["meshes"][by_name(document)[f"Oak_LOD1_{part}"]["mesh"]]
        (primitive,) = mesh["primitives"]
        for name, values in getattr(asset.winds[1], part).items():
            stored = decode(document, buffer, primitive["attributes"][name])
            whole = np.issubdtype(values.dtype, np.integer) and name != "JOINTS_0"
            expected = values / np.iinfo(values.dtype).max if whole else values
            np.testing.assert_allclose(stored[:, : values.shape[1]], expected)
            if name.startswith("_"):
                assert stored.shape[1] == 4, "Blender reads only equally wide ones"


def test_colours_that_are_wind_leave_the_mean_to_the_material(tmp_path):
    asset = equipped("colors", sway=False)
    document, _ = take_apart(encode_glb(asset))
    leaves = asset.levels[0].foliage
    factor = document["materials"][1]["pbrMetallicRoughness"]["baseColorFactor"][:3]
    np.testing.assert_allclose(factor, leaves.color.mean(axis=0), rtol=1e-5)
    export_tree(asset, tmp_path / "oak.glb")
    colors = read_glb(tmp_path / "oak.glb").foliage.leaf.colors
    np.testing.assert_allclose(colors, np.broadcast_to(factor, colors.shape), rtol=1e-5)


@pytest.mark.parametrize(
    ("engine", "name"), [("godot", "-convcolonly"), ("unreal", "UCX_"), ("unity", "_collider")]
)
def test_bodies_stand_where_they_are_and_bear_the_engines_names(engine, name, tmp_path):
    asset = equipped()
    document, buffer = take_apart(encode_glb(asset, quantise=True, engine=engine))
    bodies = [node for node in document["nodes"] if node.get("extras", {}).get("collision")]
    assert len(bodies) == len(asset.collision.capsule_radius) + 1
    assert all(name in node["name"] for node in bodies)
    crown = document["meshes"][bodies[-1]["mesh"]]["primitives"][0]
    corners = decode(document, buffer, crown["attributes"]["POSITION"])
    np.testing.assert_array_equal(corners, asset.collision.hull_positions)
    export_tree(asset, tmp_path / "oak.glb", engine=engine)
    assert len(inspect_file(tmp_path / "oak.glb")["bodies"]) == len(bodies)


@settings(max_examples=15, deadline=None)
@given(seed=st.integers(0, 99), scale=st.sampled_from([1e-3, 1.0, 1e3]), skinned=st.booleans())
def test_quantised_places_are_off_by_half_a_step(tmp_path_factory, seed, scale, skinned):
    rng = np.random.default_rng(seed)
    asset = equipped(sway=skinned)
    level = asset.levels[0]
    moved = (level.wood.positions * scale + rng.normal(size=3) * scale).astype(np.float32)
    wood = dataclasses.replace(level.wood, positions=moved)
    asset = dataclasses.replace(asset, levels=(dataclasses.replace(level, wood=wood), *asset.levels[1:]))
    path = tmp_path_factory.mktemp("quantised") / "oak.glb"
    path.write_bytes(encode_glb(asset, quantise=True))
    again = read_glb(path)
    every = [asset.cards[0].mesh.positions]
    for each in asset.levels:
        every += [each.wood.positions, merge_leaves(each.foliage).positions]
    edge = max(np.ptp(np.concatenate(every), axis=0))
    for read, written in (
        (again.wood, wood),
        (again.foliage.leaf, merge_leaves(level.foliage)),
    ):
        np.testing.assert_allclose(read.positions, written.positions, rtol=0, atol=edge / 65534 * 0.51)
        np.testing.assert_array_equal(read.triangles, written.triangles)
        length = np.linalg.norm(read.normals, axis=1)
        np.testing.assert_allclose(length, 1, atol=0.02)
        assert ((read.normals * written.normals).sum(axis=1) > 0.99 * length).all()


def test_instanced_leaves_come_back_as_they_were(tmp_path):
    tree = meshed_tree()
    path = tmp_path / "oak.glb"
    export_tree(tree, path, params=ExportParams(instanced=True))
    leaves, again = tree.foliage, read_glb(path).foliage
    np.testing.assert_array_equal(again.leaf.positions, leaves.leaf.positions)
    for name in ("position", "scale", "color"):
        np.testing.assert_array_equal(getattr(again, name), getattr(leaves, name))
    np.testing.assert_allclose(again.rotation, leaves.rotation, atol=1e-6)
    found = inspect_file(path)
    assert found["triangles"] == triangles(tree)
    merged = merge_leaves(leaves).positions
    low = np.minimum(merged.min(axis=0), tree.wood.positions.min(axis=0))
    np.testing.assert_allclose(found["bounds"]["min"], low, atol=1e-5)
    assert found["extensions"]["required"] == ["EXT_mesh_gpu_instancing"]


def test_levels_in_files_of_their_own(tmp_path):
    asset = equipped()
    written = export_tree(asset, tmp_path / "oak.glb", params=ExportParams(separate_levels=True))
    assert [path.name for path in written] == [f"oak_LOD{k}.glb" for k in range(4)]
    found = [inspect_file(path) for path in written]
    assert [each["triangles"] for each in found] == [*map(triangles, asset.levels), 4]
    assert [bool(each["bodies"]) for each in found] == [True, False, False, False]
    assert [len(each["skins"]) for each in found] == [1, 1, 1, 0]
    lone = export_tree(meshed_tree(), tmp_path / "one.glb", params=ExportParams(separate_levels=True))
    assert [path.name for path in lone] == ["one.glb"]
    meshes = export_tree(asset, tmp_path / "oak.ply", params=ExportParams(separate_levels=True))
    assert [path.name for path in meshes] == [f"oak_LOD{k}.ply" for k in range(3)]


def test_inspecting_says_what_levels_there_are(tmp_path):
    asset = equipped()
    export_tree(asset, tmp_path / "oak.glb")
    found = inspect_file(tmp_path / "oak.glb")
    assert [level["triangles"] for level in found["levels"]] == [*map(triangles, asset.levels), 4]
    assert found["triangles"] == triangles(asset.levels[0])
    assert found["skins"] == [{"joints": len(asset.winds[0].armature.parent)}]
    assert [motion["name"] for motion in found["animations"]] == ["sway"]
    assert found["extensions"] == {"used": ["MSFT_lod"], "required": []}
    assert found["warnings"] == []


def test_a_translucent_leaf_says_so(tmp_path):
    tree = meshed_tree()
    leaf = dataclasses.replace(tree.foliage.material, translucency=0.4)
    tree = dataclasses.replace(tree, foliage=dataclasses.replace(tree.foliage, material=leaf))
    export_tree(tree, tmp_path / "oak.glb")
    assert read_glb(tmp_path / "oak.glb").foliage.material.translucency == 0.4
    assert inspect_file(tmp_path / "oak.glb")["extensions"]["required"] == []


def test_tangents_are_written_where_a_normal_map_is(tmp_path):
    tree = meshed_tree()
    export_tree(tree, tmp_path / "oak.glb")
    again = read_glb(tmp_path / "oak.glb")
    np.testing.assert_allclose(again.wood.tangents, tree.wood.tangents, atol=1e-6)
    assert again.foliage.leaf.tangents is None


def change(asset: TreeAsset, **changes) -> TreeAsset:
    return dataclasses.replace(asset, **changes)


@pytest.mark.parametrize(
    ("asset", "options", "message"),
    [
        (TreeAsset(()), {}, "needs a level or a card"),
        (change(equipped(), winds=equipped().winds[:1]), {}, "must be given for all 3 levels or none"),
        (change(equipped(), winds=equipped().winds[::-1]), {}, "must have 480 rows|must have .* rows"),
        (equipped(), {"instanced": True}, "cannot carry wind"),
        (equipped(), {"engine": "gogot"}, "collision engine: must be one of"),
    ],
)
def test_a_broken_asset_is_refused(asset, options, message):
    with pytest.raises(InputError, match=message):
        encode_glb(asset, **options)


@pytest.mark.parametrize("ending", [".obj", ".ply", ".usdc"])
def test_what_only_glb_can_is_refused_elsewhere(tmp_path, ending):
    with pytest.raises(InputError, match=r"quantise: needs a \.glb file"):
        export_tree(meshed_tree(), tmp_path / f"oak{ending}", params=ExportParams(quantise=True))
