"""Other programs read the trees that are made of pictures: the bundled pair and the known trees."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
import trimesh

import flowtree.cli.demo
from benchmarks.measure_truth import INPUTS, load_truth
from flowtree.configuration import override_params
from flowtree.export.export_tree import export_tree
from flowtree.export.merge_leaves import merge_leaves
from flowtree.geometry.closed_surfaces import is_closed, weld
from flowtree.model.tree import TreeModel
from flowtree.params import Params
from flowtree.pipeline.reconstruct import reconstruct
from tests.clients.node import load_in_three, validate_glb

_PAIR = [Path(flowtree.cli.demo.__file__).parent / "demo" / f"photo_{k}.jpg" for k in (0, 1)]
_TRUTH = Path(__file__).parents[2] / ".." / "shared" / "data" / "truth"
_KNOWN = ("aspen", "birch", "maple_bare", "willow")
# Of every part less: what the clients could stumble over is there in small numbers, too.
_SMALL = override_params(
    Params(),
    [
        "photos.working_height=384",
        "flow.particle_count=500",
        "twigs.most=500",
        "leaves.most=2000",
        "density.resolution=32",
    ],
)


class Made(NamedTuple):
    path: Path
    tree: TreeModel


def _made(path: Path, photos, height: float) -> Made:
    tree = reconstruct(photos, yaws=(0.0, 90.0), height=height, params=_SMALL).tree
    export_tree(tree, path)
    return Made(path, tree)


@pytest.fixture(scope="module")
def bundled(tmp_path_factory) -> list[Made]:
    return [_made(tmp_path_factory.mktemp("bundled") / "demo.glb", _PAIR, 11.0)]


@pytest.fixture(scope="module")
def known(tmp_path_factory) -> list[Made]:
    if not _TRUTH.is_dir():
        pytest.skip("the test data beside the project is not there")
    folder, made = tmp_path_factory.mktemp("known"), []
    for name in _KNOWN:
        truth = load_truth(_TRUTH / name)
        pictures = [_TRUTH / name / truth.photos[yaw].name for yaw in INPUTS]
        made.append(_made(folder / f"{name}.glb", pictures, truth.height))
    return made


@pytest.fixture(params=["bundled", "known"])
def made(request) -> list[Made]:
    trees: list[Made] = request.getfixturevalue(request.param)
    return trees


def _triangles(tree: TreeModel) -> dict[str, int]:
    counts = {f"{tree.name}_wood": len(tree.wood.triangles)}
    if tree.foliage is not None:
        counts[f"{tree.name}_leaves"] = len(merge_leaves(tree.foliage).triangles)
    return counts


def test_the_validator_finds_nothing_wrong(made):
    for (_, tree), report in zip(made, validate_glb(*(path for path, _ in made)), strict=True):
        assert report["issues"]["numWarnings"] == 0, report["issues"]["messages"][:3]
        assert report["info"]["totalTriangleCount"] == sum(_triangles(tree).values())


def test_three_and_trimesh_load_the_same_tree(made):
    for (path, tree), loaded in zip(made, load_in_three(*(path for path, _ in made)), strict=True):
        scene, expected = trimesh.load_scene(path), _triangles(tree)
        assert {name: mesh["triangles"] for name, mesh in loaded["meshes"].items()} == expected
        assert {name: len(mesh.faces) for name, mesh in scene.geometry.items()} == expected
        np.testing.assert_array_equal(np.array(loaded["bounds"], np.float32), scene.bounds.astype(np.float32))
        low, high = scene.bounds[:, 1]
        assert abs(low) < 0.05 * tree.height, "it stands on the ground"
        assert 0.85 * tree.height < high < 1.1 * tree.height


def test_a_leafy_tree_has_leaves_in_its_file_and_a_bare_one_none(known):
    with_leaves = {path.stem for path, _ in known if len(trimesh.load_scene(path).geometry) == 2}
    assert {"aspen", "birch"} <= with_leaves
    assert "maple_bare" not in with_leaves


def test_the_wood_in_the_file_is_closed_with_its_outside_out(made):
    for path, tree in made:
        wood = trimesh.load_scene(path).geometry[f"{tree.name}_wood"]
        assert is_closed(weld(np.asarray(wood.vertices), np.asarray(wood.faces)))
        cone = np.pi * float(tree.skeleton.radius[0]) ** 2 * tree.height / 3.0
        assert wood.volume > 0.2 * cone
