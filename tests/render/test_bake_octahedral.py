from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from flowtree.geometry.projection import view_axes
from flowtree.model.camera import Camera
from flowtree.model.mesh import TreeMesh
from flowtree.render.bake_octahedral import bake_octahedral
from flowtree.render.look_up_impostor import look_up_impostor, nearest_frames
from flowtree.render.render_mask import render_mask
from flowtree.render.soft_iou import soft_iou
from tests.levels.trees import crowned_tree
from tests.render.cards import check_card

TREE = crowned_tree(4, leaves=8000)
OCTAHEDRAL = bake_octahedral(TREE, size=1024, frames=8, device="cpu")


def _camera(yaw: float, size: int = 128) -> Camera:
    """The view of the octahedral card's square."""
    places = OCTAHEDRAL.mesh.positions.astype(float)
    side, middle = float(np.ptp(places[:, 0])), places.mean(axis=0)
    right = view_axes(yaw)[0]
    scale = side / size
    return Camera(
        yaw, scale, (size / 2 - float(middle @ right) / scale, size / 2 + middle[1] / scale), size, size
    )


@pytest.mark.parametrize("yaw", [0.0, 7.0, 20.0, 33.0, 71.0, 125.0, 200.0, 307.0])
def test_an_octahedral_card_looks_like_the_tree_between_its_pictures(yaw):
    camera = _camera(yaw)
    shown = look_up_impostor(OCTAHEDRAL, view_axes(yaw)[2], camera.width)
    mask = render_mask(TREE, camera, device="cpu")
    assert soft_iou(shown[:, :, 3], camera, mask, camera, height=TREE.height) >= 0.9


def test_a_baked_direction_shows_its_picture():
    """At yaw 90 the eye looks along +x: the lower right picture."""
    side = OCTAHEDRAL.material.base_color.shape[0] // 8
    shown = look_up_impostor(OCTAHEDRAL, np.array([1.0, 0.0, 0.0]), side)
    stored = OCTAHEDRAL.material.base_color[-side:, -side:] / 255.0
    assert np.allclose(shown[:, :, 3], stored[:, :, 3], atol=1e-5)
    there = stored[:, :, 3] > 0.1
    assert np.allclose(shown[there][:, :3], stored[there][:, :3], atol=1e-4)


def test_weights_of_pictures_are_shares_that_change_smoothly():
    rng = np.random.default_rng(0)
    for toward in rng.normal(size=(50, 3)):
        toward[1] = abs(toward[1])
        near = nearest_frames(toward, 5)
        weights = np.array([weight for _, weight in near])
        assert weights.sum() == pytest.approx(1.0)
        assert (weights >= -1e-12).all()
        assert all(0 <= k < 5 for frame, _ in near for k in frame)


def test_an_octahedral_card_is_a_proper_mesh_and_its_texture_has_no_dark_rim():
    check_card(OCTAHEDRAL)


def test_the_same_tree_bakes_the_same_bytes():
    one, two = (bake_octahedral(TREE, size=64, frames=2, device="cpu").material for _ in range(2))
    assert one.base_color.tobytes() == two.base_color.tobytes()


def test_depth_lets_pictures_of_other_sides_agree():
    """Two thin stems before and behind the axis: between two pictures they would stand in the wrong place."""
    points = np.array([[-0.1, 0, 3], [0.1, 0, 3], [0.1, 8, 3], [-0.1, 8, 3]], np.float32)
    card = TreeMesh(
        np.concatenate([points, points * [1, 1, -1]]).astype(np.float32),
        np.tile(np.float32([0, 0, 1]), (8, 1)),
        np.zeros((8, 2), np.float32),
        np.array([[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]], np.int32),
    )
    tree = dataclasses.replace(TREE, wood=card, foliage=None)
    baked = bake_octahedral(tree, size=512, frames=4, device="cpu")
    toward = view_axes(12.0)[2]
    shown = look_up_impostor(baked, toward, 96)
    side = float(np.ptp(baked.mesh.positions[:, 0]))
    across = (np.arange(96) + 0.5) / 96 * side - 0.5 * side
    spread = np.abs(across[shown[40:56, :, 3].max(axis=0) > 0.25])
    assert np.allclose(spread, 3.0 * np.sin(np.radians(12.0)), atol=0.25)
