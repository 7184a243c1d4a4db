from __future__ import annotations

import dataclasses
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.errors import InputError
from flowtree.export.check_tree import check_tree
from flowtree.geometry.closed_surfaces import is_watertight, without_sheets
from flowtree.meshing.close_seams import close_seams
from flowtree.model.tree import TreeModel
from flowtree.pipeline.build_levels import build_levels
from flowtree.render.fit_camera import fit_camera
from flowtree.render.render_mask import render_mask
from flowtree.render.soft_iou import soft_iou
from tests.levels.trees import crowned_tree

TREE = crowned_tree(1)
BARE = dataclasses.replace(TREE, foliage=None)
FRESH = crowned_tree(5, leaves=0)


def _count(tree: TreeModel) -> int:
    foliage = tree.foliage
    return len(tree.wood.triangles) + (
        0 if foliage is None else len(foliage.position) * len(foliage.leaf.triangles)
    )


def _leaves(tree: TreeModel) -> set[tuple[float, ...]]:
    return set() if tree.foliage is None else {tuple(turn) for turn in tree.foliage.rotation}


def _nodes(tree: TreeModel) -> set[tuple[float, ...]]:
    return {tuple(point) for point in tree.skeleton.points}


@given(budget=st.integers(400, 30_000), seed=st.integers(0, 20), bare=st.booleans())
@settings(deadline=None, max_examples=6)
def test_levels_keep_their_budgets_and_lie_in_each_other(budget, seed, bare):
    levels = build_levels(BARE if bare else TREE, max_triangles=budget, seed=seed, count=3, device="cpu")
    least = (budget, int(0.8 * budget), max(64, min(4000, budget // 15)))
    for level, most in zip(levels, least, strict=True):
        assert _count(level) <= most
        check_tree(level)
        parent = level.skeleton.parent
        assert parent[0] == -1
        assert (parent[1:] < np.arange(1, len(parent))).all()
        assert is_watertight(without_sheets(close_seams(level.wood)[1]))
        assert level.bark.double_sided or is_watertight(close_seams(level.wood)[1])
        assert level.wood.node is not None
        assert level.wood.node.max() < len(parent)
        if level.foliage is not None:
            assert level.foliage.node.max() < len(parent)
    assert is_watertight(close_seams(levels[0].wood)[1])
    assert not levels[0].bark.double_sided
    for fine, coarse in pairwise(levels):
        assert bare or _leaves(coarse) <= _leaves(fine)
        assert _nodes(coarse) <= _nodes(fine)


def test_a_tree_that_fits_stays_as_it_is():
    assert build_levels(TREE, max_triangles=10_000_000, count=1)[0] is TREE
    assert build_levels(TREE, max_triangles=0, count=2)[0] is TREE


def test_most_of_a_budget_is_used():
    for tree, budget in ((TREE, 6000), (FRESH, 4000)):
        (level,) = build_levels(tree, max_triangles=budget, count=1, device="cpu")
        assert _count(level) > 0.8 * budget


@pytest.mark.parametrize("budget", [11_000, 12_200, 12_800])
def test_wood_keeps_its_area_where_all_branches_just_fit(budget):
    """Rather fewer branches of the right width than all of them, too thin."""
    (level,) = build_levels(BARE, max_triangles=budget, count=1, device="cpu")
    assert _surface(level) == pytest.approx(_surface(BARE), rel=0.05)


@pytest.mark.parametrize("budget", [24_000, 26_000, 30_000])
def test_where_all_branches_fit_the_room_is_for_their_shape(budget):
    """With a second level half as large as it may be, thin branches were flat and a tenth too thin."""
    levels = build_levels(BARE, max_triangles=budget, count=2, device="cpu")
    for level in levels:
        assert len(level.skeleton.parent) == len(BARE.skeleton.parent)
        assert _surface(level) == pytest.approx(_surface(BARE), rel=0.015)
    assert _count(levels[0]) > 0.75 * budget


def _surface(tree: TreeModel) -> float:
    a, b, c = (tree.wood.positions[tree.wood.triangles[:, k]].astype(float) for k in range(3))
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum())


def test_a_budget_smaller_than_the_trunk_is_an_error():
    with pytest.raises(InputError, match=r"max_triangles: must be at least .* for the trunk alone"):
        build_levels(BARE, max_triangles=3, count=1, device="cpu")
    with pytest.raises(InputError, match="levels: must be 1 to 4"):
        build_levels(TREE, count=5)
    with pytest.raises(InputError, match="max_triangles: must be 0 or more"):
        build_levels(TREE, max_triangles=-1)


def test_the_same_seed_gives_the_same_bytes_and_another_one_others():
    def arrays(seed):
        (level,) = build_levels(TREE, max_triangles=3000, count=1, seed=seed, device="cpu")
        assert level.foliage is not None
        return [level.wood.positions, level.wood.triangles, level.foliage.position, level.foliage.scale]

    one, again, other = arrays(0), arrays(0), arrays(7)
    assert all(a.tobytes() == b.tobytes() for a, b in zip(one, again, strict=True))
    assert any(a.tobytes() != b.tobytes() for a, b in zip(one, other, strict=True))


@pytest.mark.parametrize("shape", ["broad", "needle"])
def test_a_level_looks_like_the_tree(shape):
    tree = crowned_tree(3, shape=shape)
    levels = build_levels(tree, max_triangles=10_000, count=2, device="cpu")
    for yaw in (20.0, 110.0):
        camera = fit_camera(tree, yaw, 160)
        masks = [render_mask(each, camera, device="cpu") for each in (tree, *levels)]
        for mask in masks[1:]:
            assert mask.sum() == pytest.approx(masks[0].sum(), rel=0.2)
        fidelity = soft_iou(masks[1], camera, masks[2], camera, height=tree.height)
        assert fidelity > 0.8


@pytest.fixture(scope="module")
def carded():
    """A bare tree of 34,000 triangles in four levels."""
    return build_levels(FRESH, max_triangles=30_000, count=4, device="cpu")


def test_far_levels_of_a_bare_tree_have_limbs_and_cards(carded):
    assert [level.foliage is None for level in carded] == [True, True, False, False]
    far, farthest = carded[2:]
    assert far.foliage is farthest.foliage  # one picture in the file
    assert not far.foliage.material.mipmaps
    assert _nodes(far) == _nodes(farthest) < _nodes(carded[0])
    assert _count(far) <= 30_000 // 15
    assert _count(farthest) < 0.9 * _count(far)
    assert _count(farthest) <= 30_000 // 60
    for level in carded:
        check_tree(level)


@pytest.mark.parametrize("yaw", [15.0, 80.0])
def test_far_levels_of_a_bare_tree_look_like_it(carded, yaw):
    camera = fit_camera(carded[0], yaw, 128)
    masks = [render_mask(level, camera, device="cpu") for level in carded]
    for number in (2, 3):
        assert soft_iou(masks[0], camera, masks[number], camera, height=FRESH.height) >= 0.8
        limbs = render_mask(dataclasses.replace(carded[number], foliage=None), camera, device="cpu")
        assert soft_iou(masks[0], camera, limbs, camera, height=FRESH.height) < 0.7


def test_cards_are_lit_as_a_crown_is(carded):
    """Each card's normals look out of the crown from its own side."""
    leaf = carded[2].foliage.leaf
    assert np.allclose(np.linalg.norm(leaf.normals, axis=1), 1.0, atol=1e-5)
    corners = leaf.positions.reshape(-1, 4, 3)
    facing = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert (np.sum(leaf.normals.reshape(-1, 4, 3) * facing[:, None], axis=2) > 0).all()
    outward = leaf.positions - leaf.positions.mean(axis=0)
    top = outward[:, 1] > 0
    assert np.abs(leaf.normals[top, 1]).mean() > 0.1


def test_wood_that_knows_no_nodes_and_small_budgets_have_no_cards():
    unknown = dataclasses.replace(FRESH, wood=dataclasses.replace(FRESH.wood, node=None))
    for tree, budget in ((unknown, 30_000), (FRESH, 10_000)):
        assert all(
            level.foliage is None for level in build_levels(tree, max_triangles=budget, count=3, device="cpu")
        )
