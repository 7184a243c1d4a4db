"""three.js in a browser shows every kind of GLB that we write, as large and as finely meshed as it is."""

from __future__ import annotations

import base64
import io

import numpy as np
import pytest
from PIL import Image

from flowtree.export.export_tree import export_tree
from flowtree.export.merge_leaves import merge_leaves
from flowtree.params import ExportParams
from tests.assets import equipped, levelled, meshed_tree
from tests.browser.chromium import open_page

_TREE = meshed_tree()
_FILES = {
    "plain.glb": (_TREE, ExportParams()),
    "small.glb": (_TREE, ExportParams(quantise=True)),
    "instanced.glb": (_TREE, ExportParams(instanced=True)),
    "levels.glb": (levelled(), ExportParams()),
    "all.glb": (equipped(), ExportParams(quantise=True)),
}


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    folder = tmp_path_factory.mktemp("load")
    for name, (tree, params) in _FILES.items():
        export_tree(tree, folder / name, params=params)
    with open_page("load.html", folder) as shown:
        yield shown


def pixels(loaded):
    data = base64.b64decode(loaded["picture"].split(",")[1])
    return np.asarray(Image.open(io.BytesIO(data)).convert("RGB"), int)


@pytest.mark.parametrize("name", _FILES)
def test_three_shows_the_whole_tree(page, name):
    loaded = page.evaluate("name => load(name)", name)
    wood, leaves = _TREE.wood, merge_leaves(_TREE.foliage)
    seen = [count for part, count in loaded["meshes"].items() if "-convcolonly" not in part]
    assert sorted(seen) == sorted([len(wood.triangles), len(leaves.triangles)])
    every = np.concatenate([wood.positions, leaves.positions])
    if name != "all.glb":  # solid bodies stand out of it
        atol = 1e-4 if name == "small.glb" else 1e-5
        np.testing.assert_allclose(loaded["bounds"], [every.min(axis=0), every.max(axis=0)], atol=atol)
    picture = pixels(loaded)
    sky = np.abs(picture - picture[0, 0]).max(axis=2) < 8
    assert 0.02 < 1 - sky.mean() < 0.6, "a tree, not a wall and not nothing"
    green = picture[..., 1] > np.maximum(picture[..., 0], picture[..., 2]) + 10
    assert green.sum() > 500


def test_other_levels_are_scenes_of_their_own(page):
    loaded = page.evaluate("load('levels.glb', 2)")
    assert loaded["scenes"] == [f"{name}_scene" for name in ("Oak", "Oak_LOD1", "Oak_LOD2", "Oak_LOD3")]
    assert set(loaded["meshes"]) == {"Oak_LOD2_wood", "Oak_LOD2_leaves"}
    card = page.evaluate("load('levels.glb', 3)")
    assert card["meshes"] == {"Oak_LOD3": 4}
    assert page.evaluate("load('all.glb')")["animations"] == ["sway"]


def test_all_ways_to_store_it_look_alike(page):
    plain, small, instanced = (
        pixels(page.evaluate("name => load(name)", f"{name}.glb")) for name in ("plain", "small", "instanced")
    )
    assert np.abs(plain - small).mean() < 2
    # The normals of instanced leaves are their own, not the crown's.
    assert np.abs(plain - instanced).mean() < 6
