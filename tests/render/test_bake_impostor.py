from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from flowtree.errors import InputError
from flowtree.geometry.projection import view_axes
from flowtree.model.camera import Camera
from flowtree.model.foliage import Foliage
from flowtree.model.mesh import TreeMesh
from flowtree.render.bake_impostor import bake_crossed, bake_octahedral
from flowtree.render.dilate_colors import dilate_colors
from flowtree.render.keep_coverage import keep_coverage
from flowtree.render.look_up_impostor import look_up_impostor, nearest_frames
from flowtree.render.render_mask import render_mask
from flowtree.render.soft_iou import soft_iou
from tests.levels.trees import crowned_tree

TREE = crowned_tree(4, leaves=8000)
OCTAHEDRAL = bake_octahedral(TREE, size=1024, frames=8, device="cpu")
CROSSED = bake_crossed(TREE, size=256, device="cpu")


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


def _as_leaf(card):
    """The card alone, for the project's own renderer."""
    none = np.zeros((0, 3), np.float32)
    wood = TreeMesh(none, none, np.zeros((0, 2), np.float32), np.zeros((0, 3), np.int32))
    one = np.zeros((1, 3), np.float32)
    still = np.array([[0, 0, 0, 1]], np.float32)
    ones = np.ones(1, np.float32)
    leaf = Foliage(card.mesh, card.material, one, still, ones, one + 1, np.zeros(1, np.int32))
    return dataclasses.replace(TREE, wood=wood, foliage=leaf)


@pytest.mark.parametrize("yaw", [0.0, 25.0, 90.0, 150.0])
def test_crossed_cards_look_like_the_tree(yaw):
    camera = _camera(yaw)
    cards = render_mask(_as_leaf(CROSSED), camera, device="cpu")
    mask = render_mask(TREE, camera, device="cpu")
    assert soft_iou(cards, camera, mask, camera, height=TREE.height) >= 0.65


@pytest.mark.parametrize("card", [OCTAHEDRAL, CROSSED], ids=["octahedral", "crossed"])
def test_a_card_is_a_proper_mesh_and_its_texture_has_no_dark_rim(card):
    mesh = card.mesh
    a, b, c = (mesh.positions[mesh.triangles[:, k]].astype(float) for k in range(3))
    facing = np.cross(b - a, c - a)
    assert (np.sum(facing * mesh.normals[mesh.triangles[:, 0]], axis=1) > 0).all()
    assert np.allclose(np.sum(mesh.normals * mesh.tangents[:, :3], axis=1), 0, atol=1e-6)
    picture = card.material.base_color
    clear, solid = picture[:, :, 3] == 0, picture[:, :, 3] == 255
    assert clear.any()
    assert solid.any()
    assert picture[clear][:, :3].max(axis=1).min() > 0.3 * np.median(picture[solid][:, :3].max(axis=1))
    normal = card.material.normal[:, :, :3] / 127.5 - 1.0
    assert np.allclose(np.linalg.norm(normal, axis=2), 1.0, atol=0.02)
    assert (normal[:, :, 2] > -0.01).all()


def test_the_same_tree_bakes_the_same_bytes():
    one, two = (bake_octahedral(TREE, size=64, frames=2, device="cpu").material for _ in range(2))
    assert one.base_color.tobytes() == two.base_color.tobytes()


def test_nothing_cannot_be_baked():
    with pytest.raises(InputError, match="needs a triangle or a leaf"):
        bake_crossed(dataclasses.replace(_as_leaf(CROSSED), foliage=None))


def test_dilated_colours_go_on_outside_and_stay_inside():
    values = np.zeros((9, 13, 2), np.float32)
    weight = np.zeros((9, 13), np.float32)
    weight[2:5, 3:6] = 1.0
    values[2:5, 3:6] = (0.25, 0.75)
    filled = dilate_colors(values, weight)
    assert np.allclose(filled, (0.25, 0.75), atol=1e-6)
    assert np.array_equal(dilate_colors(values, np.zeros_like(weight)), values)


@pytest.mark.parametrize("cover", [0.1, 0.3, 0.7])
def test_as_much_passes_the_test_as_was_covered(cover):
    rng = np.random.default_rng(3)
    alpha = np.clip(rng.normal(cover, 0.1, (64, 80)), 0, 1).astype(np.float32)
    alpha[:, :8] = 0.0
    alpha[:, 72:] = 1.0
    bent = keep_coverage(alpha, 0.5)
    assert (bent[:, 16:64] >= 0.5).mean() == pytest.approx(alpha[:, 16:64].mean(), abs=0.03)
    assert (bent[:, :8] == 0.0).all()
    assert (bent[:, 72:] == 1.0).all()


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
