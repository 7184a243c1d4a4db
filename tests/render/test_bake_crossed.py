from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from flowtree.errors import InputError
from flowtree.model.foliage import Foliage
from flowtree.model.mesh import TreeMesh
from flowtree.render.bake_crossed import bake_crossed
from flowtree.render.fit_camera import fit_camera
from flowtree.render.render_mask import render_mask
from flowtree.render.soft_iou import soft_iou
from tests.levels.trees import crowned_tree
from tests.render.cards import check_card

LEAFY = crowned_tree(4, leaves=8000)
BARE = dataclasses.replace(LEAFY, foliage=None)
CARDS = {"leafy": (LEAFY, bake_crossed(LEAFY, size=1024, device="cpu"))}
CARDS["bare"] = (BARE, bake_crossed(BARE, size=1024, device="cpu"))


def _alone(card):
    """The card alone, for the project's own renderer."""
    none = np.zeros((0, 3), np.float32)
    wood = TreeMesh(none, none, np.zeros((0, 2), np.float32), np.zeros((0, 3), np.int32))
    one = np.zeros((1, 3), np.float32)
    still = np.array([[0, 0, 0, 1]], np.float32)
    ones = np.ones(1, np.float32)
    leaf = Foliage(card.mesh, card.material, one, still, ones, one + 1, np.zeros(1, np.int32))
    return dataclasses.replace(LEAFY, wood=wood, foliage=leaf)


def _likeness(tree, card, yaw):
    camera = fit_camera(tree, yaw, 128)
    cards, mask = (render_mask(shown, camera, device="cpu") for shown in (_alone(card), tree))
    return soft_iou(cards, camera, mask, camera, height=tree.height)


@pytest.mark.parametrize("kind", CARDS)
@pytest.mark.parametrize("yaw", [0.0, 25.0, 90.0, 150.0, 200.0])
def test_crossed_cards_look_like_the_tree_from_all_sides(kind, yaw):
    assert _likeness(*CARDS[kind], yaw) >= 0.8


def test_more_cards_show_a_bare_tree_better():
    few = bake_crossed(BARE, cards=1, size=1024, device="cpu")
    for yaw in (10.0, 45.0):
        assert _likeness(BARE, few, yaw) + 0.05 < _likeness(*CARDS["bare"], yaw)


@pytest.mark.parametrize("kind", CARDS)
def test_the_trunk_is_seen_once(kind):
    """Below the crown its silhouette is no wider than the trunk by more than a little, and has no gaps."""
    tree, card = CARDS[kind]
    low = tree.skeleton.points[:, 1]
    free = float(low[tree.skeleton.level > 0].min())
    for yaw in (0.0, 20.0, 75.0):
        camera = fit_camera(tree, yaw, 512)
        rows = slice(
            int(camera.foot[1] - 0.8 * free / camera.metres_per_pixel),
            int(camera.foot[1] - 0.1 * free / camera.metres_per_pixel),
        )
        cards, mask = (render_mask(shown, camera, device="cpu")[rows] for shown in (_alone(card), tree))
        assert rows.stop > rows.start
        assert 0.7 * mask.sum() < cards.sum() < 1.3 * mask.sum()
        assert np.minimum(cards, mask).sum() > 0.75 * mask.sum()
        assert (cards.sum(axis=1) > 0.5 * mask.sum(axis=1)).all()


@pytest.mark.parametrize("kind", CARDS)
def test_crossed_cards_are_a_proper_mesh_and_have_no_dark_rim(kind):
    check_card(CARDS[kind][1])


def test_one_card_of_each_direction_crosses_the_others_in_the_trunk():
    card = bake_crossed(BARE, cards=1, size=256)
    assert len(card.mesh.triangles) == 6
    normals = card.mesh.normals[::4].astype(float)
    away = np.sum(card.mesh.positions[::4] * normals, axis=1)
    thick = BARE.skeleton.points[(BARE.skeleton.level == 0) & (BARE.skeleton.radius > 0.17)]
    for normal, distance in zip(normals, away, strict=True):
        along = thick @ normal
        assert along.min() <= distance <= along.max()


def test_a_tree_of_one_leaf_has_cards_for_it_alone():
    each = ("position", "rotation", "scale", "color", "node")
    only = dataclasses.replace(LEAFY.foliage, **{name: getattr(LEAFY.foliage, name)[:1] for name in each})
    tree = dataclasses.replace(_alone(CARDS["leafy"][1]), foliage=only)
    card = bake_crossed(tree, size=64)
    assert len(card.mesh.triangles) == 6
    check_card(card)


def test_the_same_tree_bakes_the_same_bytes(monkeypatch):
    """On any number of cores."""
    monkeypatch.setenv("FLOWTREE_THREADS", "1")
    one = bake_crossed(BARE, cards=3, size=256)
    monkeypatch.setenv("FLOWTREE_THREADS", "2")
    two = bake_crossed(BARE, cards=3, size=256)
    assert one.material.base_color.tobytes() == two.material.base_color.tobytes()
    assert one.material.normal.tobytes() == two.material.normal.tobytes()
    assert one.mesh.positions.tobytes() == two.mesh.positions.tobytes()


def test_nothing_cannot_be_baked():
    with pytest.raises(InputError, match="needs a triangle or a leaf"):
        bake_crossed(dataclasses.replace(_alone(CARDS["bare"][1]), foliage=None))


def test_a_texture_too_small_for_all_cards_is_refused():
    with pytest.raises(InputError, match=r"impostor: needs room for .* pictures of 8 pixels.*fewer"):
        bake_crossed(LEAFY, cards=32, size=64)
