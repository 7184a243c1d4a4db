"""The GLB holds the tree: every buffer decodes to what went in, and the same tree gives the same bytes."""

from __future__ import annotations

import dataclasses
import errno
import io
import json
import os
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from flowtree import __version__
from flowtree.errors import InputError, OutputError
from flowtree.export.merge_leaves import merge_leaves
from flowtree.export.write_glb import encode_glb, write_glb
from flowtree.model.mesh import Material, TreeMesh
from flowtree.model.tree import TreeModel
from tests.trees import bare_tree, hand_made_tree, leaf_quad, scatter_leaves, unusual_tree

WIDTH = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
KIND = {5120: np.int8, 5121: np.uint8, 5122: np.int16, 5123: np.uint16, 5125: np.uint32, 5126: np.float32}


def take_apart(data: bytes) -> tuple[dict[str, Any], bytes]:
    """The document and the buffer, read as the specification's section 4.4 says and in no other way."""
    magic, version, total, length, kind = struct.unpack_from("<4sIII4s", data)
    assert (magic, version, total, kind) == (b"glTF", 2, len(data), b"JSON")
    assert length % 4 == 0
    size, kind = struct.unpack_from("<I4s", data, 20 + length)
    assert kind == b"BIN\0"
    assert 28 + length + size == total
    return json.loads(data[20 : 20 + length]), data[28 + length :]


def decode(document: dict[str, Any], buffer: bytes, index: int) -> np.ndarray:
    accessor = document["accessors"][index]
    view = document["bufferViews"][accessor["bufferView"]]
    kind, width = np.dtype(KIND[accessor["componentType"]]), WIDTH[accessor["type"]]
    stride = view.get("byteStride", kind.itemsize * width)
    assert view["byteOffset"] % 4 == 0
    if view.get("target") == 34962:
        assert stride % 4 == 0, "vertices lie at multiples of four bytes"
    assert view["byteLength"] == accessor["count"] * stride
    shape, strides = (accessor["count"], width), (stride, kind.itemsize)
    values = np.ndarray(shape, kind, buffer, view["byteOffset"], strides)
    if not accessor.get("normalized"):
        return values
    return np.maximum(values / np.iinfo(kind).max, -1.0)


def picture(document: dict[str, Any], buffer: bytes, texture: int) -> np.ndarray:
    image = document["images"][document["textures"][texture]["source"]]
    view = document["bufferViews"][image["bufferView"]]
    data = buffer[view["byteOffset"] : view["byteOffset"] + view["byteLength"]]
    opened = Image.open(io.BytesIO(data))
    assert f"image/{opened.format.lower()}" == image["mimeType"]
    return np.asarray(opened)


def random_mesh(rng: np.random.Generator, vertices: int, triangles: int, colored: bool) -> TreeMesh:
    normals = rng.normal(size=(vertices, 3))
    return TreeMesh(
        positions=rng.normal(0, 5, (vertices, 3)).astype(np.float32),
        normals=(normals / np.linalg.norm(normals, axis=1, keepdims=True)).astype(np.float32),
        uvs=rng.random((vertices, 2)).astype(np.float32),
        triangles=rng.integers(0, vertices, (triangles, 3)).astype(np.int32),
        colors=rng.random((vertices, 3)).astype(np.float32) if colored else None,
    )


@st.composite
def trees(draw: st.DrawFn) -> TreeModel:
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    vertices = draw(st.sampled_from([1, 2, 3, 50, 65535, 65536]))
    wood = random_mesh(rng, vertices, draw(st.sampled_from([0, 1, 30])), draw(st.booleans()))
    tree = hand_made_tree(0, name=draw(st.text(max_size=8)))
    leaves = draw(st.sampled_from([None, 0, 1, 7, 300] if len(wood.triangles) else [1, 300]))
    foliage = None if leaves is None else scatter_leaves(tree.skeleton, leaves, int(rng.integers(99)))
    if foliage is not None:
        leaf = random_mesh(rng, draw(st.integers(1, 9)), draw(st.integers(1, 5)), draw(st.booleans()))
        foliage = dataclasses.replace(foliage, leaf=leaf)
    size = draw(st.tuples(st.integers(1, 80), st.integers(1, 80)))
    bark = Material(
        "bark",
        rng.integers(0, 256, (*size, draw(st.sampled_from([3, 4]))), np.uint8),
        draw(st.sampled_from([None, np.full((4, 5, 3), 128, np.uint8)])),
        roughness=float(rng.random()),
    )
    return dataclasses.replace(tree, wood=wood, bark=bark, foliage=foliage)


def assert_holds(
    document: dict[str, Any], buffer: bytes, node: dict, mesh: TreeMesh, material: Material
) -> None:
    assert document["meshes"][node["mesh"]]["name"] == node["name"]
    (primitive,) = document["meshes"][node["mesh"]]["primitives"]
    attributes = primitive["attributes"]
    positions = decode(document, buffer, attributes["POSITION"])
    np.testing.assert_array_equal(positions, mesh.positions)
    entry = document["accessors"][attributes["POSITION"]]
    np.testing.assert_array_equal(np.array(entry["min"]), mesh.positions.min(axis=0).astype(np.float64))
    np.testing.assert_array_equal(np.array(entry["max"]), mesh.positions.max(axis=0).astype(np.float64))
    np.testing.assert_allclose(decode(document, buffer, attributes["NORMAL"]), mesh.normals, atol=1e-6)
    inside = mesh.uvs.min() >= 0 and mesh.uvs.max() <= 1  # then as 16-bit fractions of the picture
    uvs = decode(document, buffer, attributes["TEXCOORD_0"])
    np.testing.assert_allclose(uvs, mesh.uvs, rtol=0, atol=0.51 / 65535 if inside else 0)
    indices = decode(document, buffer, primitive["indices"])
    assert indices.dtype == (np.uint16 if len(mesh.positions) < 65536 else np.uint32)
    np.testing.assert_array_equal(indices.reshape(-1, 3), mesh.triangles)
    entry = document["materials"][primitive["material"]]
    surface = entry["pbrMetallicRoughness"]
    assert surface["metallicFactor"] == 0
    assert surface["roughnessFactor"] == pytest.approx(material.roughness)
    if mesh.colors is not None:
        factor = np.array(surface["baseColorFactor"][:3])
        decoded = decode(document, buffer, attributes["COLOR_0"])
        assert (decoded[:, 3] == 1).all()
        # Half a step of a byte, relative to the brightest.
        np.testing.assert_allclose(decoded[:, :3] * factor, mesh.colors, atol=0.502 / 255 * factor.max())
    else:
        assert "COLOR_0" not in attributes
    pixels = picture(document, buffer, surface["baseColorTexture"]["index"])
    if material.alpha_cutoff is None:
        assert pixels.shape == (*material.base_color.shape[:2], 3)
    else:
        assert entry["alphaMode"] == "MASK"
        assert entry["alphaCutoff"] == material.alpha_cutoff
        np.testing.assert_array_equal(pixels, material.base_color)
    assert entry.get("doubleSided", False) == material.double_sided
    if material.normal is not None:
        np.testing.assert_array_equal(
            picture(document, buffer, entry["normalTexture"]["index"]), material.normal
        )


@settings(max_examples=25, deadline=None)
@given(tree=trees())
def test_every_buffer_decodes_to_what_went_in(tree: TreeModel) -> None:
    data = encode_glb(tree)
    document, buffer = take_apart(data)
    name = tree.name or "Tree"
    parts = {}
    if len(tree.wood.triangles):
        parts[f"{name}_wood"] = (tree.wood, tree.bark)
    if tree.foliage is not None and len(tree.foliage.position):
        parts[f"{name}_leaves"] = (merge_leaves(tree.foliage), tree.foliage.material)
    root = document["nodes"][document["scenes"][0]["nodes"][0]]
    assert root["name"] == name
    assert [document["nodes"][child]["name"] for child in root["children"]] == list(parts)
    for child in root["children"]:
        node = document["nodes"][child]
        assert_holds(document, buffer, node, *parts[node["name"]])
    assert document["asset"]["generator"] == f"flowtree {__version__}"
    assert data == encode_glb(tree)


def test_flat_and_small_pictures_are_exact_and_large_bark_is_jpeg() -> None:
    def bark_of(size: int) -> tuple[np.ndarray, np.ndarray, str]:
        y, x = np.mgrid[:size, :size]
        pixels = np.stack([x * 2, y * 2, x + y], axis=-1).astype(np.uint8)
        document, buffer = take_apart(
            encode_glb(dataclasses.replace(bare_tree(), bark=Material("b", pixels)))
        )
        return picture(document, buffer, 0), pixels, document["images"][0]["mimeType"]

    decoded, pixels, media = bark_of(63)
    assert media == "image/png"
    np.testing.assert_array_equal(decoded, pixels)
    decoded, pixels, media = bark_of(64)
    assert media == "image/jpeg"
    assert np.abs(decoded.astype(int) - pixels).mean() < 4


def test_bark_repeats_and_leaves_do_not() -> None:
    document, _ = take_apart(encode_glb(hand_made_tree()))
    wrap = {
        image["name"]: document["samplers"][texture["sampler"]]["wrapS"]
        for texture, image in zip(document["textures"], document["images"], strict=True)
    }
    assert wrap == {"bark": 10497, "bark_normal": 10497, "leaf": 33071}


def test_colours_that_want_no_mipmaps_are_sampled_themselves_and_normals_have_them() -> None:
    tree = hand_made_tree()
    tree = dataclasses.replace(tree, bark=dataclasses.replace(tree.bark, mipmaps=False))
    document, _ = take_apart(encode_glb(tree))
    smaller = {
        image["name"]: document["samplers"][texture["sampler"]]["minFilter"]
        for texture, image in zip(document["textures"], document["images"], strict=True)
    }
    assert smaller == {"bark": 9729, "bark_normal": 9987, "leaf": 9987}


def test_normals_of_no_or_odd_length_become_unit_vectors() -> None:
    tree = unusual_tree()
    tree.wood.normals[1] = (0, 3, 4)
    document, buffer = take_apart(encode_glb(tree))
    normals = decode(document, buffer, document["meshes"][0]["primitives"][0]["attributes"]["NORMAL"])
    np.testing.assert_allclose(normals, [[0, 1, 0], [0, 0.6, 0.8], [0, 1, 0]], atol=1e-7)


def broken(part: str, **change: Any) -> TreeModel:
    tree = hand_made_tree(3)
    if part == "tree":
        return dataclasses.replace(tree, **change)
    return dataclasses.replace(tree, **{part: dataclasses.replace(getattr(tree, part), **change)})


NAN = np.full((3, 3), np.nan, np.float32)
NO_MESH = TreeMesh(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros((0, 2)), np.zeros((0, 3), np.int32))


@pytest.mark.parametrize(
    ("tree", "message"),
    [
        (broken("wood", normals=np.zeros((2, 3))), "wood's normals: must have shape"),
        (broken("wood", triangles=np.array([[0, 1, 10**6]])), "wood's triangles: must be at most"),
        (broken("wood", triangles=np.array([[0, 1, -1]])), "wood's triangles: must be at least 0"),
        (broken("wood", positions=np.full((390, 3), np.inf)), "wood's positions: must be finite"),
        (broken("wood", positions=np.full((390, 3), 1e300)), "wood's positions: must be at most"),
        (broken("foliage", position=NAN), "leaf positions: must be finite"),
        (broken("foliage", rotation=np.zeros((3, 4))), "leaf rotations: must be unit quaternions"),
        (broken("foliage", color=np.full((3, 3), 2.0)), "leaf colours: must be at most 1"),
        (broken("foliage", scale=np.full(3, -1.0)), "leaf lengths: must be at least 0"),
        (broken("foliage", scale=np.ones(2)), "leaf lengths: must have shape"),
        (broken("bark", base_color=np.zeros((4, 4), np.uint8)), "bark's texture: must be"),
        (broken("bark", base_color=np.zeros((4, 4, 3))), "bark's texture: must be"),
        (broken("bark", base_color=np.zeros((0, 4, 3), np.uint8)), "bark's texture: must be"),
        (broken("bark", normal=np.zeros((4, 4, 4), np.uint8)), "bark's normal map: must be"),
        (broken("bark", roughness=float("nan")), "bark's roughness: must lie in 0..1"),
        (broken("bark", alpha_cutoff=7.0), "bark's alpha cutoff: must lie in 0..1"),
        (broken("tree", wood=NO_MESH, foliage=None), "tree: needs a triangle"),
        (broken("tree", height=float("nan")), "tree's height: must be"),
    ],
)
def test_a_broken_tree_is_refused_before_anything_is_written(
    tmp_path: Path, tree: TreeModel, message: str
) -> None:
    path = tmp_path / "tree.glb"
    path.write_bytes(b"old")
    with pytest.raises(InputError, match=message):
        write_glb(tree, path)
    assert path.read_bytes() == b"old"


def test_a_full_disk_leaves_the_old_tree(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "tree.glb"
    path.write_bytes(b"old")

    def full(_: int) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OutputError, match="free some space"):
        write_glb(bare_tree(), path)
    assert path.read_bytes() == b"old"
    assert [entry.name for entry in tmp_path.iterdir()] == ["tree.glb"]


def test_a_name_that_is_no_text_is_written_all_the_same() -> None:
    document, _ = take_apart(encode_glb(dataclasses.replace(bare_tree(), name="a\udcffb")))
    assert document["nodes"][0]["name"] == "a?b"
    assert (
        take_apart(encode_glb(dataclasses.replace(bare_tree(), name="Ölbaum 木")))[0]["nodes"][0]["name"]
        == "Ölbaum 木"
    )


def test_leaf_quads_face_the_way_their_rotation_says() -> None:
    assert (np.cross(*np.diff(leaf_quad().positions[leaf_quad().triangles[0]], axis=0)) * [0, 0, 1]).sum() > 0
