"""Cards and sprays as three.js shows them from afar, where smaller copies of textures would empty them."""

from __future__ import annotations

import base64
import dataclasses
import io

import numpy as np
import pytest
from PIL import Image

from flowtree.export.write_glb import write_glb
from flowtree.model.asset import TreeAsset
from flowtree.params import AssetParams
from flowtree.pipeline.build_asset import build_asset
from tests.browser.chromium import open_page
from tests.levels.trees import crowned_tree

LEAFY = crowned_tree(4, leaves=8000)
TREES = {"leafy": LEAFY, "bare": dataclasses.replace(LEAFY, foliage=None)}


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    folder = tmp_path_factory.mktemp("far")
    for name, tree in TREES.items():
        kind = "none" if name == "leafy" else "crossed"
        params = AssetParams(max_triangles=20_000, levels=3, impostor=kind, impostor_size=1024)
        asset = build_asset(tree, params, device="cpu")
        assert asset.levels[2].foliage.material.name.endswith({"leafy": "_spray", "bare": "_twigs"}[name])
        for number, level in enumerate(asset.levels):
            write_glb(TreeAsset((level,)), folder / f"{name}{number}.glb")
        for card in asset.cards:
            alone = dataclasses.replace(tree, wood=card.mesh, bark=card.material, foliage=None)
            write_glb(TreeAsset((alone,)), folder / f"{name}_card.glb")
    with open_page("wind.html", folder) as shown:
        yield shown


def _covered(page, file, heights):
    """How many pixels it covers from so many of its heights away."""
    page.evaluate("file => load(file)", file)
    eye = np.array([0.35, 0.0, 0.94]) * heights * LEAFY.height + [0.0, 0.5 * LEAFY.height, 0.0]
    page.evaluate("([from, at]) => look(from, at)", [eye.tolist(), [1.0, 0.5 * LEAFY.height, 0.0]])
    data = page.evaluate("picture(0)")
    shown = np.asarray(Image.open(io.BytesIO(base64.b64decode(data.split(",")[1]))).convert("RGB"), float)
    return np.abs(shown - shown[0, 0]).max(axis=2).sum()


@pytest.mark.parametrize("heights", [2.5, 8.0, 20.0])
@pytest.mark.parametrize(("name", "least"), [("leafy2", 0.8), ("bare2", 0.6), ("bare_card", 0.6)])
def test_as_much_is_there_from_afar(page, name, least, heights):
    finest = _covered(page, f"{name.removesuffix('2').removesuffix('_card')}0.glb", heights)
    assert finest > 0
    assert least < _covered(page, f"{name}.glb", heights) / finest < 1.6
