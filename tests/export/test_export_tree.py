"""OBJ and PLY hold the same tree as the GLB; all of it is written, or nothing."""

from __future__ import annotations

import dataclasses
import errno
import os
from pathlib import Path

import numpy as np
import pytest
import trimesh
from PIL import Image

from flowtree.errors import InputError, OutputError
from flowtree.export.export_tree import TREE_ENDINGS, export_tree
from flowtree.export.mean_color import mean_color
from flowtree.export.merge_leaves import merge_leaves
from flowtree.export.tint_texture import tint_texture
from flowtree.geometry.srgb import encode_srgb_bytes
from flowtree.model.mesh import Material, TreeMesh
from flowtree.model.tree import TreeModel
from tests.trees import bare_tree, hand_made_tree, unusual_tree

TREES = (hand_made_tree(), bare_tree(), unusual_tree())


def meshes_of(tree: TreeModel) -> list[TreeMesh]:
    return [tree.wood] if tree.foliage is None else [tree.wood, merge_leaves(tree.foliage)]


def corners_of(meshes: list[TreeMesh]) -> np.ndarray:
    return np.concatenate([mesh.positions[mesh.triangles] for mesh in meshes])


def parse_obj(text: str) -> dict[str, np.ndarray]:
    lines = [line.split() for line in text.splitlines()]
    found = {
        key: np.array([line[1:] for line in lines if line[0] == key], float) for key in ("v", "vt", "vn")
    }
    faces = [[corner.split("/") for corner in line[1:]] for line in lines if line[0] == "f"]
    return found | {"f": np.array(faces, int) - 1}


@pytest.mark.parametrize("tree", TREES, ids=lambda tree: tree.name)
def test_obj_holds_the_tree(tmp_path: Path, tree: TreeModel) -> None:
    path = tmp_path / f"{tree.name}.obj"
    export_tree(tree, path)
    obj, meshes = parse_obj(path.read_text()), meshes_of(tree)
    np.testing.assert_allclose(obj["v"][obj["f"][:, :, 0]], corners_of(meshes), rtol=1e-6, atol=1e-6)
    uvs = np.concatenate([mesh.uvs[mesh.triangles] for mesh in meshes]) * [1, -1] + [0, 1]
    np.testing.assert_allclose(obj["vt"][obj["f"][:, :, 1]], uvs, atol=1e-5)
    normals = np.concatenate([mesh.normals[mesh.triangles] for mesh in meshes])
    np.testing.assert_allclose(obj["vn"][obj["f"][:, :, 2]], normals, atol=1e-3)
    mtl = (tmp_path / f"{tree.name}.mtl").read_text()
    pictures = {line.split()[1] for line in mtl.splitlines() if line.startswith(("map_", "norm"))}
    assert {entry.name for entry in tmp_path.iterdir()} == pictures | {path.name, f"{tree.name}.mtl"}
    used = {line.split()[1] for line in path.read_text().splitlines() if line.startswith("usemtl")}
    assert used == {line.split()[1] for line in mtl.splitlines() if line.startswith("newmtl")}


@pytest.mark.parametrize("tree", TREES, ids=lambda tree: tree.name)
@pytest.mark.parametrize("ending", [".obj", ".ply"])
def test_trimesh_reads_the_same_triangles(tmp_path: Path, tree: TreeModel, ending: str) -> None:
    path = tmp_path / f"{tree.name}{ending}"
    export_tree(tree, path)
    scene, corners = trimesh.load_scene(path, process=False), corners_of(meshes_of(tree))
    assert sum(len(part.faces) for part in scene.geometry.values()) == len(corners)
    np.testing.assert_allclose(scene.bounds, [corners.min(axis=(0, 1)), corners.max(axis=(0, 1))], atol=1e-5)


def test_obj_with_spaces_in_its_name_still_finds_its_files(tmp_path: Path) -> None:
    path = tmp_path / "my old oak.obj"
    export_tree(hand_made_tree(name="my old oak"), path)
    assert {entry.name for entry in tmp_path.iterdir()} == {
        "my old oak.obj",
        "my_old_oak.mtl",
        "my_old_oak_wood.jpg",
        "my_old_oak_wood_normal.jpg",
        "my_old_oak_leaves.png",
    }
    parts = trimesh.load_scene(path).geometry
    assert set(parts) == {"my_old_oak_wood", "my_old_oak_leaves"}
    assert parts["my_old_oak_wood"].visual.material.image.size == (64, 64)


def test_obj_pictures_carry_the_leaves_mean_colour(tmp_path: Path) -> None:
    tree = hand_made_tree()
    assert tree.foliage is not None
    export_tree(tree, tmp_path / "oak.obj")
    picture = np.asarray(Image.open(tmp_path / "oak_leaves.png"))
    expected = mean_color(tree.foliage.material) * tree.foliage.color.mean(axis=0)
    np.testing.assert_allclose(mean_color(Material("", picture)), expected, atol=0.01)
    np.testing.assert_array_equal(picture[..., 3], tree.foliage.material.base_color[..., 3])


def test_ply_colours_are_what_the_textures_are_from_afar(tmp_path: Path) -> None:
    tree = hand_made_tree()
    assert tree.foliage is not None
    export_tree(tree, tmp_path / "oak.ply")
    mesh = trimesh.load(tmp_path / "oak.ply", process=False)
    colors = mesh.visual.vertex_colors[:, :3]
    wood = len(tree.wood.positions)
    np.testing.assert_array_equal(colors[:wood], np.tile(encode_srgb_bytes(mean_color(tree.bark)), (wood, 1)))
    expected = encode_srgb_bytes(tree.foliage.color * mean_color(tree.foliage.material))
    np.testing.assert_array_equal(colors[wood::4], expected)
    leaves = merge_leaves(tree.foliage)
    np.testing.assert_array_equal(mesh.vertices[wood:], leaves.positions)


def test_white_tints_nothing_and_grey_darkens() -> None:
    picture = np.random.default_rng(0).integers(0, 256, (4, 5, 4), np.uint8)
    np.testing.assert_array_equal(tint_texture(picture, np.ones(3)), picture)
    assert (tint_texture(picture, np.full(3, 0.5)) <= picture).all()


def test_transparent_parts_do_not_count_in_the_mean() -> None:
    picture = np.zeros((2, 2, 4), np.uint8)
    picture[0, 0] = (255, 0, 255, 255)
    np.testing.assert_allclose(mean_color(Material("", picture)), [1, 0, 1])
    picture[..., 3] = 0
    np.testing.assert_allclose(mean_color(Material("", picture)), [0.25, 0, 0.25])


@pytest.mark.parametrize("ending", TREE_ENDINGS)
def test_the_same_tree_gives_the_same_bytes(tmp_path: Path, ending: str) -> None:
    for folder in (tmp_path / "a", tmp_path / "b"):
        folder.mkdir()
        export_tree(hand_made_tree(), folder / f"tree{ending}")
    for path in (tmp_path / "a").iterdir():
        assert path.read_bytes() == (tmp_path / "b" / path.name).read_bytes()


@pytest.mark.parametrize("ending", TREE_ENDINGS)
def test_broken_trees_and_missing_folders_leave_nothing_behind(tmp_path: Path, ending: str) -> None:
    tree = bare_tree()
    broken = dataclasses.replace(
        tree, wood=dataclasses.replace(tree.wood, positions=tree.wood.positions * np.nan)
    )
    with pytest.raises(InputError, match="must be finite"):
        export_tree(broken, tmp_path / f"tree{ending}")
    with pytest.raises(OutputError, match="make that folder first"):
        export_tree(tree, tmp_path / "missing" / f"tree{ending}")
    assert not list(tmp_path.iterdir())


def test_a_full_disk_in_the_middle_of_an_obj_keeps_all_old_files(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "oak.obj"
    export_tree(bare_tree(), path)
    before = {entry: entry.read_bytes() for entry in tmp_path.iterdir()}
    left = 2

    def full(_: int) -> None:
        nonlocal left
        left -= 1
        if left < 0:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OutputError, match="free some space"):
        export_tree(hand_made_tree(), path)
    assert {entry: entry.read_bytes() for entry in tmp_path.iterdir()} == before


@pytest.mark.parametrize("name", ["tree.fbx", "tree", "tree.glb.txt"])
def test_an_unknown_ending_names_the_known_ones(tmp_path: Path, name: str) -> None:
    with pytest.raises(InputError, match=r"must end in \.glb, \.obj, \.ply"):
        export_tree(bare_tree(), tmp_path / name)
    assert not list(tmp_path.iterdir())
