from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from flowtree.geometry.closed_surfaces import is_watertight, without_sheets
from flowtree.levels.limit_textures import limit_textures
from flowtree.levels.pack_atlas import pack_atlas
from flowtree.meshing.close_seams import close_seams
from flowtree.meshing.paint_bark import paint_bark
from flowtree.pipeline.build_levels import build_levels
from flowtree.render.fit_camera import fit_camera
from flowtree.render.render_mask import render_mask
from flowtree.render.render_view import render_view
from tests.levels.trees import crowned_tree

TREE = dataclasses.replace(crowned_tree(6, limbs=12, leaves=800), bark=paint_bark((104, 90, 74)))


def test_the_tree_looks_the_same_with_an_atlas():
    (packed,) = pack_atlas([TREE])
    camera = fit_camera(TREE, 30.0, 200)
    assert np.abs(render_mask(packed, camera) - render_mask(TREE, camera)).mean() < 2e-3
    before, after = (render_view(tree, camera).astype(float) for tree in (TREE, packed))
    # Bark is halved to a ray's size from other neighbours, leaves lie between other texels.
    assert np.abs(before - after).mean() < 2.0


def test_levels_share_one_picture_and_stay_closed():
    levels = build_levels(TREE, max_triangles=6000, count=3, device="cpu")
    leaves = len({id(each.foliage.material) for each in levels})
    assert leaves == 2  # one of them a spray
    levels = pack_atlas(levels)
    pictures = {id(part.base_color) for each in levels for part in (each.bark, each.foliage.material)}
    assert len(pictures) == leaves
    for level in levels:
        assert level.bark.base_color is level.foliage.material.base_color
        assert is_watertight(without_sheets(close_seams(level.wood)[1]))
        for mesh in (level.wood, level.foliage.leaf):
            assert ((mesh.uvs[:, 0] >= 0) & (mesh.uvs[:, 0] <= 1)).all()
        assert level.bark.repeats


def test_wood_shows_the_same_bark():
    """The atlas at the new coordinates is the tile at the old ones."""
    (packed,) = pack_atlas([TREE])
    tile, atlas = TREE.bark.base_color, packed.bark.base_color
    old, new = TREE.wood.uvs[TREE.wood.triangles], packed.wood.uvs[packed.wood.triangles]
    apart = np.ptp(old[:, :, 0], axis=1) < 0.9  # not the hidden floors
    shares = np.random.default_rng(0).dirichlet(np.ones(3), len(old))[:, :, None]

    def shown(uv, picture):
        at = (uv * shares).sum(axis=1)[apart]
        rows, columns = picture.shape[:2]
        column = np.floor(at[:, 0] * columns).astype(int) % columns
        row = np.floor(at[:, 1] * rows).astype(int) % rows
        return picture[row, column, :3].astype(float)

    differs = np.abs(shown(old, tile) - shown(new, atlas)).max(axis=1)
    assert (differs < 40).mean() > 0.95


def test_a_bare_tree_needs_no_atlas():
    bare = dataclasses.replace(TREE, foliage=None)
    assert pack_atlas([bare])[0] is bare


@pytest.mark.parametrize("size", [16, 100, 256])
def test_textures_are_halved_until_they_fit(size):
    (small,) = limit_textures([TREE], size)
    for part, whole in ((small.bark, TREE.bark), (small.foliage.material, TREE.foliage.material)):
        assert max(part.base_color.shape[:2]) <= size
        assert part.base_color.shape[2] == whole.base_color.shape[2]
        light, before = (each.base_color[:, :, :3].astype(float).mean() for each in (part, whole))
        assert light == pytest.approx(before, rel=0.35)
    normal = small.bark.normal / 127.5 - 1.0
    assert np.allclose(np.linalg.norm(normal, axis=2), 1.0, atol=0.02)


def test_textures_that_fit_stay():
    assert limit_textures([TREE], 4096)[0] is TREE


def test_pictures_that_want_no_smaller_copies_keep_their_share_of_covered_pixels():
    leaf = TREE.foliage.material
    alpha = np.where(np.random.default_rng(0).random((256, 256)) < 0.1, 255, 0).astype(np.uint8)
    dots = np.concatenate([np.full((256, 256, 3), 90, np.uint8), alpha[:, :, None]], axis=2)
    for mipmaps, share in ((False, pytest.approx(0.1, abs=0.02)), (True, 0.0)):
        material = dataclasses.replace(leaf, base_color=dots, mipmaps=mipmaps)
        tree = dataclasses.replace(TREE, foliage=dataclasses.replace(TREE.foliage, material=material))
        (small,) = limit_textures([tree], 64)
        picture = small.foliage.material.base_color
        assert picture.shape == (64, 64, 4)
        assert (picture[:, :, 3] >= 128).mean() == share
