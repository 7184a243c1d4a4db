"""The border of the writers: what a tree's levels, cards, wind and bodies must be to become a file."""

from __future__ import annotations

import numpy as np

from flowtree import check
from flowtree.export.check_skeleton import MOST_METRES
from flowtree.export.check_tree import check_material, check_mesh, check_tree
from flowtree.model.asset import TreeAsset
from flowtree.model.collision import Collision
from flowtree.model.tree import TreeModel
from flowtree.model.wind import Armature, Sway, Wind

_WIDEST = 4  # columns of a vertex attribute


def check_asset(asset: TreeAsset) -> None:
    """Refuses an asset that would make a broken file.

    Raises:
        InputError: neither level nor card, a broken one (see `check_tree`), a card without a triangle, a wind
            for some levels only or for other vertices, joints that do not come parents first, NaN anywhere.
    """
    something = bool(asset.levels) or bool(asset.cards)
    check.require(something, "tree", "needs a level or a card", "neither", "build the finest level at least")
    for level in asset.levels:
        check_tree(level)
    for card in asset.cards:
        check_mesh(card.mesh, f"{card.name} card")
        check_material(card.material, f"{card.name} card's material", deep=card.frames > 1)
        triangles = len(card.mesh.triangles)
        check.require(triangles > 0, f"{card.name} card", "needs a triangle", triangles, "bake it again")
    each = len(asset.winds) in (0, len(asset.levels))
    rule = f"must be given for all {len(asset.levels)} levels or none"
    check.require(each, "winds", rule, len(asset.winds), "weigh each level's wind")
    for level, wind in zip(asset.levels, asset.winds, strict=False):
        _check_wind(level, wind)
    if asset.collision is not None:
        _check_collision(asset.collision)


def _check_wind(level: TreeModel, wind: Wind) -> None:
    leaves = 0
    if level.foliage is not None:
        leaves = len(level.foliage.position) * len(level.foliage.leaf.positions)
    joints = 0 if wind.armature is None else len(wind.armature.parent)
    for part, count in (("wood", len(level.wood.positions)), ("leaves", leaves)):
        attributes = getattr(wind, part)
        for name, values in attributes.items():
            thing = f"{part}'s {name}"
            fits = values.ndim == 2 and values.shape[0] == count and 1 <= values.shape[1] <= _WIDEST
            rule = f"must have {count} rows of 1 to {_WIDEST} columns"
            check.require(fits, thing, rule, values.shape, "weigh the wind of this level")
            finite = bool(np.isfinite(values).all())
            check.require(finite, thing, "must be finite", "NaN or infinity", "weigh the wind again")
        skinned = {"JOINTS_0", "WEIGHTS_0"} <= attributes.keys()
        missing = joints > 0 and count > 0 and not skinned
        check.require(
            not missing, f"{part}'s skin", "needs JOINTS_0 and WEIGHTS_0", "joints alone", "bind the vertices"
        )
        if skinned and count:
            most = int(attributes["JOINTS_0"].max())
            rule = f"must name joints below {joints}"
            check.require(most < joints, f"{part}'s skin", rule, most, "bind them to this armature")
    if wind.armature is not None:
        _check_armature(wind.armature, wind.sway)


def _check_armature(armature: Armature, sway: Sway | None) -> None:
    count = len(armature.parent)
    before = count > 0 and armature.parent[0] == -1
    before = before and bool(((armature.parent[1:] >= 0) & (armature.parent[1:] < np.arange(1, count))).all())
    rule = "must start with the root, -1, and name earlier joints"
    check.require(before, "joints' parents", rule, "another order", "sort the joints parents first")
    check.array(armature.points, "joints' places", shape=(count, 3), low=-MOST_METRES, high=MOST_METRES)
    if sway is None:
        return
    times = check.array(sway.times, "sway's times", shape=(None,), low=0.0)
    growing = len(times) > 0 and bool((np.diff(times) > 0).all())
    check.require(growing, "sway's times", "must grow", "others", "sort them")
    turns = check.array(sway.rotation, "sway's rotations", shape=(len(times), count, 4), dtype=np.float64)
    unit = bool((np.abs(np.linalg.norm(turns, axis=2) - 1.0) < 1e-3).all())
    check.require(unit, "sway's rotations", "must be unit quaternions", "others", "normalise them")


def _check_collision(collision: Collision) -> None:
    count = len(collision.capsule_radius)
    low, high = -MOST_METRES, MOST_METRES
    check.array(collision.capsule_ends, "capsules' ends", shape=(count, 2, 3), low=low, high=high)
    check.array(collision.capsule_radius, "capsules' radii", shape=(count,), low=0.0, high=MOST_METRES)
    hull = check.array(collision.hull_positions, "hull's corners", shape=(None, 3), low=low, high=high)
    most = len(hull) - 1.0
    check.array(
        collision.hull_triangles, "hull's triangles", shape=(None, 3), dtype=np.int32, low=0.0, high=most
    )
