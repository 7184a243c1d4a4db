"""The commands that make no tree: help, params, render, inspect, matte."""

from __future__ import annotations

import dataclasses
import json
import tomllib

import numpy as np
import pytest
from PIL import Image

from flowtree import __version__
from flowtree.configuration import params_from_table
from flowtree.export.export_skeleton import export_skeleton
from flowtree.export.write_glb import write_glb
from flowtree.params import Params
from flowtree.render.fit_camera import fit_camera
from flowtree.render.render_mask import render_mask
from tests.trees import hand_made_tree

COMMANDS = ("demo", "reconstruct", "grow", "render", "matte", "params", "inspect", "warmup")


def _picture(path, size=(48, 64), alpha=None):
    """A photo with an alpha channel: a disc on a stick."""
    rows, columns = np.mgrid[0 : size[1], 0 : size[0]]
    shape = (columns - size[0] / 2) ** 2 + (rows - size[1] / 3) ** 2 < (size[0] / 3) ** 2
    shape |= (abs(columns - size[0] / 2) < 2) & (rows > size[1] / 3) & (rows < size[1] - 4)
    pixels = np.zeros((size[1], size[0], 4), np.uint8)
    pixels[..., 1] = 120
    pixels[..., 3] = 255 * shape if alpha is None else alpha
    Image.fromarray(pixels).save(path)
    return path


def _pixels(path):
    with Image.open(path) as picture:
        return np.asarray(picture)


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_explains_itself(flowtree, command):
    overview, own = flowtree("--help"), flowtree(command, "--help")
    assert (overview.code, own.code) == (0, 0)
    assert f"  {command} " in overview.out
    assert f"Usage: flowtree {command}" in own.out


def test_version(flowtree):
    assert flowtree("--version").out == f"flowtree {__version__}\n"


@pytest.mark.parametrize(
    "arguments", [(), ("plant",), ("reconstruct",), ("reconstruct", "--colour", "red"), ("render",)]
)
def test_wrong_usage_ends_with_2(flowtree, arguments):
    assert flowtree(*arguments).code == 2


def test_params_prints_a_file_that_is_read_again(flowtree, tmp_path):
    printed = flowtree("params", "--set", "flow.particle_count=123")
    assert printed.code == 0
    params = params_from_table(tomllib.loads(printed.out))
    assert params.flow.particle_count == 123
    assert params.density == Params().density
    (tmp_path / "params.toml").write_text(printed.out)
    assert flowtree("params", "--params", "params.toml").out == printed.out


def test_an_unknown_parameter_gets_the_nearest_name(flowtree):
    done = flowtree("params", "--set", "flow.particle_cuont=3")
    assert done.code == 1
    assert done.err.count("\n") == 1
    assert "did you mean 'flow.particle_count'?" in done.err


def test_render_draws_a_tree_from_its_file(flowtree, tmp_path):
    tree = hand_made_tree()
    write_glb(tree, tmp_path / "tree.glb")
    done = flowtree("render", "tree.glb", "-o", "view.png", "--size", 96, "--yaw", 30)
    assert (done.code, done.out) == (0, "view.png\n")
    assert _pixels(tmp_path / "view.png").shape == (96, 96, 4)
    assert flowtree("render", "tree.glb", "-o", "mask.png", "--size", 96, "--yaw", 30, "--mask").code == 0
    mask = _pixels(tmp_path / "mask.png") / 255.0
    expected = render_mask(tree, fit_camera(tree, 30.0, 96))
    # Leaf colours and normals lose bits in the file, places do not.
    assert np.abs(mask - expected).max() < 0.01


def test_render_refuses_to_replace_the_tree(flowtree, tmp_path):
    write_glb(hand_made_tree(), tmp_path / "tree.png")
    before = (tmp_path / "tree.png").read_bytes()
    assert flowtree("render", "tree.png", "-o", "tree.png").code == 1
    assert (tmp_path / "tree.png").read_bytes() == before


def test_inspect_says_what_a_file_holds(flowtree, tmp_path):
    tree = hand_made_tree()
    write_glb(dataclasses.replace(tree, height=3.5), tmp_path / "tree.glb")
    done = flowtree("inspect", "tree.glb")
    assert done.code == 0
    first, *lines = done.out.splitlines()
    assert first.startswith("tree.glb: glb by flowtree")
    facts = {line[:14].strip(): line[14:] for line in lines}
    assert "y 0.00 to 3.50" in facts["bounds"]
    assert facts["triangles"] == f"{len(tree.wood.triangles) + 120}; the wood is closed"
    assert facts["mesh"].startswith("Oak_leaves: 120 triangles")
    assert "note" not in facts
    export_skeleton(tree.skeleton, tmp_path / "tree.swc")
    assert "6 in 2 orders" in flowtree("inspect", "tree.swc").out


def test_inspect_prints_json(flowtree, tmp_path):
    write_glb(hand_made_tree(), tmp_path / "tree.glb")
    found = json.loads(flowtree("inspect", "tree.glb", "--json").out)
    assert found["bytes"] == (tmp_path / "tree.glb").stat().st_size


def test_a_matte_can_stand_for_its_photo(flowtree, tmp_path):
    _picture(tmp_path / "photo.png")
    done = flowtree("matte", "photo.png", "-o", "matte.png")
    assert done.code == 0
    assert "alpha channel matte" in done.out
    first, again = _pixels(tmp_path / "photo.png"), _pixels(tmp_path / "matte.png")
    assert np.array_equal(first[..., 3], again[..., 3])


def test_progress_is_a_plain_line_a_stage_without_a_terminal(flowtree, tmp_path):
    _picture(tmp_path / "photo.png")
    assert flowtree("matte", "photo.png").err.splitlines() == ["  0% photos", " 10% matting"]


def test_ctrl_c_ends_with_130_and_writes_nothing(flowtree, tmp_path, monkeypatch):
    def interrupt(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr("flowtree.matting.extract_matte.extract_matte", interrupt)
    _picture(tmp_path / "photo.png")
    done = flowtree("matte", "photo.png", "-o", "matte.png")
    assert done.code == 130
    assert done.err.splitlines()[-1] == "flowtree: stopped; every file is whole"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["photo.png"]


@pytest.mark.parametrize("error", [MemoryError(), RuntimeError("two\nlines")])
def test_even_a_fault_of_ours_is_one_line(flowtree, tmp_path, monkeypatch, error):
    def fail(*_, **__):
        raise error

    monkeypatch.setattr("flowtree.matting.extract_matte.extract_matte", fail)
    _picture(tmp_path / "photo.png")
    done = flowtree("matte", "photo.png")
    assert done.code == 1
    assert [line for line in done.err.splitlines() if not line.startswith(" ")] == [done.err.splitlines()[-1]]
    monkeypatch.setenv("FLOWTREE_DEBUG", "1")
    if isinstance(error, RuntimeError):
        with pytest.raises(RuntimeError):
            flowtree("matte", "photo.png")


@pytest.mark.parametrize("name", ["matte.gif", "missing/matte.png", "photo.png/matte.png", "."])
def test_an_output_that_cannot_be_is_refused_before_the_work(flowtree, tmp_path, monkeypatch, name):
    monkeypatch.setattr("flowtree.photos.load_photo.load_photo", lambda *_, **__: pytest.fail("work began"))
    _picture(tmp_path / "photo.png")
    done = flowtree("matte", "photo.png", "-o", name)
    assert done.code == 1
    assert done.err.count("\n") == 1


def test_without_its_extra_the_studio_says_what_to_install(flowtree, monkeypatch):
    monkeypatch.setattr("flowtree.cli.studio.find_spec", lambda name: None)
    done = flowtree("studio", "oak")
    assert done.code == 1
    assert "needs the extra `studio`" in done.err
    assert done.err.count("\n") == 1
