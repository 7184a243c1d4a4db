"""A tree in the wind as three.js shows it in a browser: by its joints, and by the shader recipe."""

from __future__ import annotations

import base64
import io

import numpy as np
import pytest
from PIL import Image

from flowtree.export.merge_leaves import merge_leaves
from flowtree.export.write_glb import write_glb
from flowtree.model.asset import TreeAsset
from flowtree.params import WindParams
from flowtree.pipeline.build_wind import build_wind
from flowtree.wind.spread_over_leaves import spread_over_leaves
from flowtree.wind.spread_over_wood import spread_over_wood
from flowtree.wind.wind_shader import WIND_SHADER
from tests.browser.chromium import open_page
from tests.pipeline.test_build_wind import grown
from tests.wind.recipe import sway
from tests.wind.skinning import pose

_SECONDS = 4.0


@pytest.fixture(scope="module")
def swaying():
    tree = grown(300)
    winds = build_wind([tree], WindParams(channels="attributes", sway=True, seconds=_SECONDS))
    return tree, winds


@pytest.fixture(scope="module")
def page(swaying, tmp_path_factory):
    tree, winds = swaying
    folder = tmp_path_factory.mktemp("wind")
    write_glb(TreeAsset((tree,), winds=winds), folder / "sway.glb")
    write_glb(TreeAsset((tree,), winds=winds), folder / "small.glb", quantise=True)
    still = build_wind([tree], WindParams(channels="attributes"))
    write_glb(TreeAsset((tree,), winds=still), folder / "still.glb")
    with open_page("wind.html", folder) as shown:
        yield shown


def picture(page, time):
    data = page.evaluate("time => picture(time)", time)
    return np.asarray(Image.open(io.BytesIO(base64.b64decode(data.split(",")[1]))).convert("RGB"), int)


def places(page, name, time):
    return np.array(page.evaluate("([name, time]) => places(name, time)", [name, time])).reshape(-1, 3)


@pytest.mark.parametrize(("file", "tolerance"), [("sway.glb", 0.005), ("small.glb", 0.02)])
def test_three_moves_every_vertex_as_the_joints_say(page, swaying, file, tolerance):
    tree, (wind,) = swaying
    loaded = page.evaluate("file => load(file)", file)
    assert loaded["seconds"] == pytest.approx(_SECONDS)
    rest = {
        "Oak_wood": (tree.wood.positions, wind.wood),
        "Oak_leaves": (merge_leaves(tree.foliage).positions, wind.leaves),
    }
    assert set(loaded["meshes"]) == set(rest)
    for key in (0, len(wind.sway.times) // 3, len(wind.sway.times) - 1):
        for name, (positions, channels) in rest.items():
            wanted = pose(
                wind.armature, wind.sway.rotation[key], positions, channels["JOINTS_0"], channels["WEIGHTS_0"]
            )
            shown = places(page, name, float(wind.sway.times[key]))
            np.testing.assert_allclose(shown, wanted, atol=tolerance)  # rotations are 16-bit in the file


def test_the_loop_closes_and_the_foot_rests_on_the_screen(page, swaying):
    tree, _ = swaying
    page.evaluate("load('sway.glb')")
    wood = {time: places(page, "Oak_wood", time) for time in (0.0, 1.0, 2.3, _SECONDS)}
    np.testing.assert_allclose(wood[_SECONDS], wood[0.0], atol=1e-5)
    low = tree.wood.positions[:, 1] < 0.05
    assert low.any()
    for now in wood.values():
        np.testing.assert_allclose(now[low], tree.wood.positions[low], atol=1e-3)
    assert np.linalg.norm(wood[2.3] - wood[1.0], axis=1).max() > 0.02
    frames = [picture(page, time) for time in (0.0, 1.0, _SECONDS)]
    assert (frames[0] != frames[1]).any(axis=2).mean() > 0.005, "it moves"
    assert (np.abs(frames[0] - frames[2]).max(axis=2) > 8).mean() < 0.001, "it ends as it began"


def test_the_recipe_runs_on_the_graphics_card_as_in_numpy(page, swaying):
    tree, (wind,) = swaying
    page.evaluate("load('still.glb')")
    leaves = merge_leaves(tree.foliage)
    for name, mesh, vertices in (
        ("Oak_wood", tree.wood, spread_over_wood(tree.skeleton, wind.weights, tree.wood)),
        ("Oak_leaves", leaves, spread_over_leaves(tree.skeleton, wind.weights, tree.foliage)),
    ):
        for time in (0.0, 2.9):
            moved = page.evaluate(
                "([name, recipe, wind, time]) => compute(name, recipe, wind, time, 0.02)",
                [name, WIND_SHADER, [1.0, 0.0, 0.5], time],
            )
            wanted = sway(
                mesh.positions, mesh.normals, vertices, wind=(1.0, 0.0, 0.5), time=time, flutter=0.02
            )
            # Phases are 8-bit in the file: up to 0.002 of a cycle beside.
            np.testing.assert_allclose(np.reshape(moved, (-1, 3)), wanted, atol=0.01)


def test_three_draws_the_tree_by_the_recipe(page):
    page.evaluate("load('still.glb')")
    page.evaluate("recipe => follow(recipe, [1, 0, 0], 0.02)", WIND_SHADER)
    frames = [picture(page, time) for time in (0.0, 1.0, 1.0)]
    assert (frames[0] != frames[1]).any(axis=2).mean() > 0.005
    assert (frames[1] == frames[2]).all()
