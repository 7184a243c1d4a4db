from __future__ import annotations

import dataclasses

import numpy as np
import pytest
import trimesh

from flowtree.collision.bound_tree import bound_tree
from flowtree.errors import InputError
from flowtree.export.name_bodies import ENGINES, name_bodies
from tests.trees import hand_made_skeleton


@pytest.fixture(scope="module")
def collision():
    return bound_tree(hand_made_skeleton(4))


@pytest.mark.parametrize("engine", ENGINES)
def test_every_body_is_a_convex_mesh_with_its_own_name(collision, engine):
    bodies = name_bodies(collision, engine, tree="Oak", mesh="Oak_wood")
    assert len(bodies) == len(collision.capsule_radius) + 1
    assert len({name for name, _, _ in bodies}) == len(bodies)
    for _, positions, triangles in bodies:
        mesh = trimesh.Trimesh(positions, triangles, process=False)
        assert mesh.is_watertight
        assert mesh.volume > 0
        assert mesh.convex_hull.volume <= mesh.volume * 1.001
    np.testing.assert_array_equal(bodies[-1][1], collision.hull_positions)


def test_the_names_are_what_importers_look_for(collision):
    named = {
        engine: [body[0] for body in name_bodies(collision, engine, tree="Oak", mesh="Oak_wood")]
        for engine in ENGINES
    }
    assert named["godot"][0] == "Oak_trunk_00-convcolonly"
    assert named["godot"][-1] == "Oak_crown-convcolonly"
    assert named["unreal"][:2] == ["UCX_Oak_wood_00", "UCX_Oak_wood_01"]
    # The importer takes what stands between the first and the last underscore for the mesh.
    assert {name[len("UCX_") : name.rindex("_")] for name in named["unreal"]} == {"Oak_wood"}
    assert named["unity"][0] == "Oak_trunk_00_collider"


def test_without_a_hull_only_capsules_are_named(collision):
    bare = dataclasses.replace(
        collision, hull_positions=np.zeros((0, 3), np.float32), hull_triangles=np.zeros((0, 3), np.int32)
    )
    assert len(name_bodies(bare, "godot", tree="Oak", mesh="Oak")) == len(collision.capsule_radius)


def test_an_unknown_engine_is_refused(collision):
    with pytest.raises(InputError, match="godot"):
        name_bodies(collision, "godo", tree="Oak", mesh="Oak")
