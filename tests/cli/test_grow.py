"""``flowtree grow``: any skeleton becomes a tree with what was asked for, or one line says why not."""

from __future__ import annotations

import json
import math
import sys

import pytest

from flowtree.export.export_skeleton import export_skeleton
from flowtree.export.inspect_file import inspect_file
from tests.trees import hand_made_skeleton

SMALL = ("--set", "twigs.most=40", "--set", "leaves.most=200")


@pytest.fixture
def skeleton(tmp_path):
    """A few limbs, as a file of another program would hold them: no twig of ours."""
    lines = ["# a neuron"]
    drawn = hand_made_skeleton()
    for k, (up, (x, y, z), radius) in enumerate(
        zip(drawn.parent, drawn.points, drawn.radius, strict=True), start=1
    ):
        lines.append(f"{k} 3 {x} {y} {z} {radius} {up + 1 if up >= 0 else -1}")
    path = tmp_path / "limbs.swc"
    path.write_text("\n".join(lines))
    return path


@pytest.mark.parametrize("ending", ["swc", "csv", "json"])
def test_our_own_skeletons_grow(flowtree, tmp_path, ending):
    export_skeleton(hand_made_skeleton(), tmp_path / f"oak.{ending}")
    done = flowtree("grow", f"oak.{ending}", *SMALL)
    assert done.code == 0, done.err
    assert done.out.startswith("tree.glb: 6 branches, ")
    found = inspect_file(tmp_path / "tree.glb")
    assert found["watertight"]
    assert len(found["meshes"]) == 2


def test_everything_that_can_be_asked_for(flowtree, tmp_path, skeleton):
    done = flowtree(
        *("grow", skeleton, "-o", "oak.glb", "--height", 9, "--seed", 3, "--report", "oak.json", *SMALL),
        *("--levels", 3, "--wind", "attributes", "--sway", "--collision", "unreal", "--quantise"),
        *("--impostor", "crossed", "--max-triangles", 3000),
    )
    assert done.code == 0, done.err
    found, report = inspect_file(tmp_path / "oak.glb"), json.loads((tmp_path / "oak.json").read_text())
    assert found["triangles"] <= 3000
    # Three levels and a card.
    assert [level["triangles"] for level in found["levels"]][:3] == [
        level["triangles"] for level in report["asset"]["levels"]
    ]
    assert len(found["levels"]) == 4
    assert report["asset"]["cards"] == ["crossed"]
    assert found["skins"] == [{"joints": report["asset"]["joints"]}]
    assert "_WIND_EXTENT" in found["meshes"][0]["attributes"]
    assert found["bodies"][0]["name"].startswith("UCX_")
    assert found["extensions"]["required"] == ["KHR_mesh_quantization"]
    assert math.isclose(report["height_m"], 9.0, rel_tol=1e-5)


def test_levels_in_files_of_their_own(flowtree, tmp_path, skeleton):
    options = ("--levels", 2, "--separate-levels", "--max-triangles", 3000)
    done = flowtree("grow", skeleton, "-o", "oak.glb", *options, *SMALL)
    assert done.code == 0, done.err
    assert sorted(path.name for path in tmp_path.glob("*.glb")) == ["oak_LOD0.glb", "oak_LOD1.glb"]
    assert done.out.startswith("oak_LOD0.glb, oak_LOD1.glb: ")


def test_textures_as_asked_for(flowtree, tmp_path, skeleton):
    done = flowtree("grow", skeleton, "--atlas", "--texture-size", 128, *SMALL)
    assert done.code == 0, done.err
    found = inspect_file(tmp_path / "tree.glb")
    assert max(max(texture["width"], texture["height"]) for texture in found["textures"]) < 400
    colors = [texture for texture in found["textures"] if not texture["name"].endswith("_normal")]
    assert len(colors) == 1, "bark and leaf share one"
    assert found["warnings"] == []


def test_quads_that_are_too_many_are_said(flowtree, tmp_path, skeleton):
    quads = ("--no-leaves", "--set", "meshing.surface=quads", *SMALL)
    few = flowtree("grow", skeleton, *quads, "--max-triangles", 2000)
    assert few.code == 0, few.err
    assert "--max-triangles 0 keeps the quads" in few.err
    whole = flowtree("grow", skeleton, *quads, "--max-triangles", 0)
    assert "note" not in whole.err
    assert inspect_file(tmp_path / "tree.glb")["watertight"]


def test_usd_without_usd_core_is_refused_before_the_work(flowtree, skeleton, monkeypatch):
    monkeypatch.setitem(sys.modules, "pxr", None)
    done = flowtree("grow", skeleton, "-o", "tree.usdc", *SMALL)
    assert done.code == 1
    assert (
        done.err
        == "flowtree: USD: needs the package usd-core, but got none; run: pip install 'flowtree-3d[usd]'\n"
    )


def test_wood_alone_and_what_was_repaired(flowtree, tmp_path):
    (tmp_path / "odd.swc").write_text("1 0 0 0 0 0 -1\n2 0 0 2 0 0 1\n3 0 0 2 0 0 2\n4 0 1 4 0 0 3\n")
    done = flowtree("grow", "odd.swc", "--no-leaves", "--no-twigs", "--report", "odd.json")
    assert done.code == 0, done.err
    warnings = json.loads((tmp_path / "odd.json").read_text())["warnings"]
    assert warnings[0].startswith("1 node dropped")
    assert "Da Vinci" in warnings[1]
    assert f"note: {warnings[0]}" in done.err
    assert [mesh["name"] for mesh in inspect_file(tmp_path / "tree.glb")["meshes"]] == ["tree_wood"]


def test_a_tree_that_lies_is_turned_up(flowtree, tmp_path):
    (tmp_path / "lying.swc").write_text("1 0 0 0 0 0.2 -1\n2 0 0 0.1 5 0.1 1\n3 0 1 0.1 8 0.05 2\n")
    noted = flowtree("grow", "lying.swc", "--no-leaves", "--no-twigs")
    assert "if z points up there, say so" in noted.err
    done = flowtree("grow", "lying.swc", "--no-leaves", "--no-twigs", "--up", "z")
    assert done.code == 0
    assert inspect_file(tmp_path / "tree.glb")["bounds"]["max"][1] > 7.9


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "needs a node"),
        ("1 0 0 0 0 1 -1", "a single node"),
        ("1 0 0 0 0 1 -1\n2 0 0 1 0 1 3\n3 0 0 2 0 1 2", "circle"),
        ("1 0 0 0 0 1 -1\n2 0 0 1 0 1 -1", "one tree, with one root"),
        ("1 0 0 0 0 1 -1\n2 0 nan 1 0 1 1", "must be finite"),
        ("1 0 0 0 0 1 -1\n2 0 0 1 0 -1 1", "radii: must be at least 0"),
        ("1 0 0 0 0 1 -1\n2 0 0 -1 0 1 1", "must rise above its root"),
        ("1 0 0 0 0 1 -1\n2 0 0 5000 0 1 1", "give its height"),
        ("1 0 0 0 0 1 -1\n2 0 0 1 0 1 7", "parent 7"),
        ("hello", "line 1"),
    ],
)
def test_a_broken_skeleton_is_one_line(flowtree, tmp_path, text, words):
    (tmp_path / "bad.swc").write_text(text)
    done = flowtree("grow", "bad.swc", *SMALL)
    assert done.code == 1
    errors = [line for line in done.err.splitlines() if "%" not in line[:4]]
    assert len(errors) == 1
    assert words in errors[0]
    assert not (tmp_path / "tree.glb").exists()


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--height", -1), "height"),
        (("--up", "x"), "up: must be y or z"),
        (("--seed", -1), "seed"),
        (("--max-triangles", 5, "--no-leaves"), "max_triangles"),
        (("--levels", 9), "levels"),
        (("--impostor", "cube"), "impostor"),
        (("--wind", "storm"), "channels"),
        (("--collision", "doom"), "engine"),
        (("--instanced", "--sway"), "cannot carry wind"),
        (("--quantise", "-o", "tree.obj"), "needs a .glb file"),
        (("-o", "limbs.swc"), "--output"),
        (("--twig", "missing.svg"), "missing.svg"),
    ],
)
def test_a_wrong_option_is_one_line(flowtree, skeleton, options, words):
    done = flowtree("grow", skeleton, *options, *SMALL)
    assert done.code == 1, done
    errors = [line for line in done.err.splitlines() if "%" not in line[:4]]
    assert len(errors) == 1, errors
    assert words in errors[0]
