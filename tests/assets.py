"""Small assets with everything that a file can hold: what tests of writers and other programs start from."""

from __future__ import annotations

import dataclasses

import numpy as np

from flowtree.collision.bound_tree import bound_tree
from flowtree.model.asset import Card, TreeAsset
from flowtree.model.mesh import Material, TreeMesh
from flowtree.model.tree import TreeModel
from flowtree.model.wind import Sway
from flowtree.params import WindParams
from flowtree.pipeline.build_wind import build_wind
from tests.trees import hand_made_tree, leaf_material


def meshed_tree(leaf_count: int = 60, *, name: str = "Oak") -> TreeModel:
    """A small tree whose wood knows its nodes and has tangents."""
    tree = hand_made_tree(leaf_count, name=name)
    wood = tree.wood
    across = np.cross(wood.normals, np.float32([0.1, 1, 0.2]))
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    tangents = np.concatenate([across, np.ones((len(across), 1))], axis=1).astype(np.float32)
    each = len(wood.positions) // (len(tree.skeleton.parent) - 1)
    node = np.repeat(np.arange(1, len(tree.skeleton.parent)), each).astype(np.int32)
    return dataclasses.replace(tree, wood=dataclasses.replace(wood, tangents=tangents, node=node))


def crossed_card(height: float = 3.5) -> Card:
    """Two quads at a right angle."""
    quad = np.array([[-1, 0, 0], [1, 0, 0], [1, height, 0], [-1, height, 0]], np.float32)
    picture = Material("card", leaf_material(64).base_color, alpha_cutoff=0.5, double_sided=True)
    return Card(
        "crossed",
        TreeMesh(
            positions=np.concatenate([quad, quad[:, [2, 1, 0]]]),
            normals=np.repeat(np.array([[0, 0, 1], [1, 0, 0]], np.float32), 4, axis=0),
            uvs=np.tile(np.array([[0, 1], [1, 1], [1, 0], [0, 0]], np.float32), (2, 1)),
            triangles=np.array([[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]], np.int32),
        ),
        picture,
    )


def levelled(name: str = "Oak") -> TreeAsset:
    """Three levels that share their bark, and a card."""
    levels = [meshed_tree(count, name=name) for count in (60, 20, 5)]
    shared = [dataclasses.replace(level, bark=levels[0].bark) for level in levels]
    return TreeAsset(tuple(shared), (crossed_card(),))


def equipped(channels: str = "attributes", *, sway: bool = True, name: str = "Oak") -> TreeAsset:
    """The same with wind and solid bodies."""
    asset = levelled(name)
    params = WindParams.model_validate({"channels": channels, "sway": sway, "joints": 9})
    bodies = bound_tree(asset.levels[0].skeleton, asset.levels[0].foliage, capsules=3)
    winds = build_wind(asset.levels, params)
    if sway:  # so coarse a tree hardly bends: one that does
        motion = nodding(len(winds[0].armature.parent))
        winds = tuple(dataclasses.replace(wind, sway=motion) for wind in winds)
    return dataclasses.replace(asset, winds=winds, collision=bodies)


def nodding(joints: int) -> Sway:
    """All joints but the first turn around z, each a little more than the one before."""
    times = np.linspace(0, 2, 9, dtype=np.float32)
    half = 0.02 * np.sin(np.pi * times)[:, None] * np.arange(joints)
    rotation = np.zeros((9, joints, 4))
    rotation[..., 2], rotation[..., 3] = np.sin(half), np.cos(half)
    return Sway("sway", times, rotation.astype(np.float32))
