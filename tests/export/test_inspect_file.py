"""What is said of a file is what was put in; a damaged file gets one clear line."""

from __future__ import annotations

import dataclasses
import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from flowtree.errors import InputError
from flowtree.export.export_skeleton import export_skeleton
from flowtree.export.export_tree import export_tree
from flowtree.export.inspect_file import inspect_file
from flowtree.export.read_glb import read_glb
from flowtree.export.write_glb import encode_glb
from flowtree.model.tree import TreeModel
from tests.assets import equipped, meshed_tree
from tests.trees import (
    bare_tree,
    hand_made_skeleton,
    hand_made_tree,
    unusual_tree,
)

quick = settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])


def pack(document: Any, buffer: bytes = b"") -> bytes:
    text = document if isinstance(document, bytes) else json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    body = (
        struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(buffer), b"BIN\0") + buffer
    )
    return struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body


def test_a_leafy_tree(tmp_path: Path) -> None:
    tree, path = hand_made_tree(), tmp_path / "oak.glb"
    export_tree(tree, path)
    found = inspect_file(path)
    assert found["bytes"] == path.stat().st_size
    assert found["nodes"] == ["Oak", "Oak_wood", "Oak_leaves"]
    assert [(mesh["name"], mesh["triangles"], mesh["materials"]) for mesh in found["meshes"]] == [
        ("Oak_wood", len(tree.wood.triangles), ["bark"]),
        ("Oak_leaves", 120, ["leaf"]),
    ]
    assert found["triangles"] == len(tree.wood.triangles) + 120
    assert [material["alpha_mode"] for material in found["materials"]] == ["OPAQUE", "MASK"]
    assert [(picture["width"], picture["height"]) for picture in found["textures"]] == [
        (64, 64),
        (64, 64),
        (32, 32),
    ]
    np.testing.assert_allclose(found["bounds"]["min"][1], 0, atol=1e-6)
    np.testing.assert_allclose(found["bounds"]["max"][1], 3.5, atol=1e-6)
    assert found["watertight"] is True
    assert found["warnings"] == []
    json.dumps(found)


def test_what_is_hardly_meant_is_said(tmp_path: Path) -> None:
    tree, path = unusual_tree(), tmp_path / "odd.glb"
    moved = dataclasses.replace(tree.wood, positions=tree.wood.positions * 1000 + np.float32(50))
    export_tree(dataclasses.replace(tree, wood=moved, foliage=None), path)
    found = inspect_file(path)
    assert found["watertight"] is False
    text = " / ".join(found["warnings"])
    for part in ("are these metres", "not watertight", "y axis does not pass"):
        assert part in text


def test_files_of_other_programs_are_placed_as_their_nodes_say(tmp_path: Path) -> None:
    path = tmp_path / "box.glb"
    scene = trimesh.Scene()
    matrix = trimesh.transformations.euler_matrix(0.3, 0.2, 0.1)
    matrix[:3, 3] = (1, 2, 3)
    scene.add_geometry(trimesh.creation.box((1, 2, 3)), node_name="box", geom_name="box", transform=matrix)
    scene.export(path)
    found = inspect_file(path)
    assert found["triangles"] == 12
    assert found["watertight"] is None
    np.testing.assert_allclose([found["bounds"]["min"], found["bounds"]["max"]], scene.bounds, atol=1e-5)


@pytest.mark.parametrize("ending", [".obj", ".ply"])
def test_other_mesh_formats(tmp_path: Path, ending: str) -> None:
    tree, path = hand_made_tree(), tmp_path / f"oak{ending}"
    export_tree(tree, path)
    found = inspect_file(path)
    assert found["triangles"] == len(tree.wood.triangles) + 120
    np.testing.assert_allclose(found["bounds"]["max"][1], 3.5, atol=1e-5)
    path.write_bytes(b"ply\nnonsense")
    if ending == ".ply":
        with pytest.raises(InputError, match="well-formed"):
            inspect_file(path)


@pytest.mark.parametrize("ending", [".swc", ".csv", ".json"])
def test_skeletons(tmp_path: Path, ending: str) -> None:
    path = tmp_path / f"oak{ending}"
    export_skeleton(hand_made_skeleton(), path)
    found = inspect_file(path)
    assert (found["nodes"], found["tips"], found["branches"], found["orders"]) == (14, 6, 6, 2)
    assert found["trunk_radius_m"] == 0.2
    assert found["bounds"]["min"][1] == 0
    json.dumps(found)


def test_skeleton_as_points(tmp_path: Path) -> None:
    path = tmp_path / "oak.ply"
    export_skeleton(hand_made_skeleton(), path)
    found = inspect_file(path)
    assert (found["triangles"], found["meshes"][0]["vertices"]) == (0, 14)


@pytest.mark.parametrize("tree", [hand_made_tree(), bare_tree(), unusual_tree()], ids=lambda tree: tree.name)
def test_our_own_trees_come_back(tmp_path: Path, tree: TreeModel) -> None:
    path = tmp_path / "tree.glb"
    export_tree(tree, path)
    again = read_glb(path)
    assert (again.name, again.height) == (tree.name, tree.height)
    for name in ("positions", "uvs", "triangles"):
        np.testing.assert_array_equal(getattr(again.wood, name), getattr(tree.wood, name))
    assert (again.foliage is None) == (tree.foliage is None)
    if tree.foliage is not None and again.foliage is not None:
        np.testing.assert_array_equal(again.foliage.material.base_color, tree.foliage.material.base_color)
        assert again.foliage.material.alpha_cutoff == tree.foliage.material.alpha_cutoff
        assert again.foliage.material.double_sided
    # What comes back is a tree that can be written: from then on nothing changes any more but the lossy bark.
    export_tree(again, path)
    third = read_glb(path)
    np.testing.assert_array_equal(third.wood.positions, tree.wood.positions)
    if again.foliage is not None and third.foliage is not None:
        for name in ("positions", "uvs", "triangles"):
            one, other = (getattr(tree.foliage.leaf, name) for tree in (third, again))
            np.testing.assert_array_equal(one, other, err_msg=name)
        np.testing.assert_allclose(third.foliage.leaf.normals, again.foliage.leaf.normals, atol=1e-6)
        np.testing.assert_allclose(third.foliage.leaf.colors, again.foliage.leaf.colors, atol=1e-6)


def test_trees_of_other_programs_are_not_ours(tmp_path: Path) -> None:
    path = tmp_path / "box.glb"
    trimesh.creation.box().export(path)
    with pytest.raises(InputError, match="must be a tree that flowtree wrote"):
        read_glb(path)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"", "must be binary glTF"),
        (b"PK\3\4" + bytes(40), "must be binary glTF"),
        (b"glTF" + struct.pack("<II", 1, 20) + bytes(8), "must be binary glTF"),
        (encode_glb(bare_tree())[:-4], "must be .* bytes, as it says"),
        (pack(b"{"), "well-formed"),
        (pack(b"[]"), "glTF document"),
        (pack(b"[" * 100_000), "well-formed|glTF document"),
        (pack({}), "well-formed"),
        (pack({"asset": {"version": "2.0"}, "nodes": 3, "scenes": [{"nodes": [0]}]}), "well-formed"),
        (pack({"asset": {}, "scenes": [{"nodes": [0]}], "nodes": [{"children": [0]}]}), "circle"),
        (pack({"asset": {}, "scenes": [{"nodes": [-1]}], "nodes": [{}]}), "no entry -1"),
        (pack({"asset": {}, "scenes": [{"nodes": [0]}], "nodes": [{"scale": [1e999, 1, 1]}]}), "not finite"),
    ],
)
def test_a_damaged_glb_gets_one_clear_line(tmp_path: Path, data: bytes, message: str) -> None:
    path = tmp_path / "tree.glb"
    path.write_bytes(data)
    for read in (inspect_file, read_glb):
        with pytest.raises(InputError, match=message if read is inspect_file else None) as caught:
            read(path)
        assert str(caught.value).startswith("tree.glb")
        assert "\n" not in str(caught.value)


DAMAGE = st.sampled_from(
    [-1, 0, 1, 7, 2**31, 2**63, 1e300, 0.5, True, None, "x", [], {}, [[]], [1, 2, 3], {"a": 1}, 5126, "VEC3"]
)


def places(value: Any, way: tuple = ()) -> list[tuple]:
    found = [way]
    for key, inner in (
        value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    ):
        found += places(inner, (*way, key))
    return found


WHOLE = [
    encode_glb(hand_made_tree(3)),
    encode_glb(equipped(), quantise=True),
    encode_glb(meshed_tree(3), instanced=True),
]


@quick
@given(data=st.data())
def test_any_damage_to_the_document_is_read_or_refused(tmp_path: Path, data: st.DataObject) -> None:
    whole = data.draw(st.sampled_from(WHOLE))
    (length,) = struct.unpack_from("<I", whole, 12)
    document, buffer = json.loads(whole[20 : 20 + length]), whole[28 + length :]
    for _ in range(data.draw(st.integers(1, 3))):
        *way, last = data.draw(st.sampled_from([way for way in places(document) if way]))
        holder = document
        for key in way:
            holder = holder[key]
        if data.draw(st.booleans()):
            holder[last] = data.draw(DAMAGE)
        else:
            del holder[last]
    path = tmp_path / "tree.glb"
    path.write_bytes(pack(document, buffer))
    for read in (inspect_file, read_glb):
        try:
            read(path)
        except InputError as error:
            assert "\n" not in str(error)  # noqa: PT017


@quick
@given(data=st.data())
def test_any_damage_to_the_bytes_is_read_or_refused(tmp_path: Path, data: st.DataObject) -> None:
    content = bytearray(data.draw(st.sampled_from(WHOLE)))
    for _ in range(data.draw(st.integers(1, 30))):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    path = tmp_path / "tree.glb"
    path.write_bytes(content)
    for read in (inspect_file, read_glb):
        try:
            read(path)
        except InputError as error:
            assert "\n" not in str(error)  # noqa: PT017


@pytest.mark.parametrize("name", ["tree.xyz", "tree"])
def test_an_unknown_ending_names_the_known_ones(tmp_path: Path, name: str) -> None:
    with pytest.raises(InputError, match=r"must end in \.glb, \.obj, \.ply, \.usda.*, \.swc, \.csv, \.json"):
        inspect_file(tmp_path / name)


@pytest.mark.parametrize("ending", [".glb", ".obj", ".ply", ".swc"])
def test_a_missing_file_is_said(tmp_path: Path, ending: str) -> None:
    with pytest.raises(InputError, match="must be a readable"):
        inspect_file(tmp_path / f"missing{ending}")
