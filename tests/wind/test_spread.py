"""From nodes to vertices: wood, leaves and skin."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.errors import InputError
from flowtree.meshing.sweep_rings import sweep_rings
from flowtree.wind.bind_joints import bind_joints
from flowtree.wind.skin_vertices import skin_vertices
from flowtree.wind.spread_over_leaves import spread_over_leaves
from flowtree.wind.spread_over_wood import spread_over_wood
from flowtree.wind.weigh_wind import weigh_wind
from tests.skeletons import random_skeleton
from tests.trees import scatter_leaves


@settings(max_examples=10, deadline=None)
@given(seed=st.integers(0, 1000))
def test_a_vertex_lies_between_the_ends_of_its_segment(seed):
    skeleton = random_skeleton(seed, 60)
    weights = weigh_wind(skeleton, height=10.0)
    wood = sweep_rings(skeleton)
    assert wood.node is not None
    vertices = spread_over_wood(skeleton, weights, wood)
    above = np.maximum(skeleton.parent, 0)
    low, high = weights.extent[above][wood.node], weights.extent[wood.node]
    assert (vertices.extent[:, :3] >= low - 1e-6).all()
    assert (vertices.extent[:, :3] <= high + 1e-6).all()
    assert (vertices.extent[:, 3] == 0).all()
    assert (vertices.phase[:, 2] == 0).all()
    np.testing.assert_array_equal(vertices.pivot, weights.pivot[wood.node])
    for name in ("depth", "pivot", "extent", "phase"):
        assert getattr(vertices, name).dtype == getattr(weights, name).dtype


def test_a_leaf_has_the_values_of_its_twig_and_flutters_at_its_tip():
    skeleton = random_skeleton(4, 60)
    weights = weigh_wind(skeleton, height=10.0)
    foliage = scatter_leaves(skeleton, 30)
    vertices = spread_over_leaves(skeleton, weights, foliage)
    corners = len(foliage.leaf.positions)
    extent = vertices.extent.reshape(30, corners, 4)
    assert (extent[:, :, :3] == extent[:, :1, :3]).all()
    np.testing.assert_array_equal(vertices.depth.reshape(30, corners)[:, 0], weights.depth[foliage.node])
    reach = np.linalg.norm(foliage.leaf.positions, axis=1)
    assert (np.diff(extent[:, np.argsort(reach), 3], axis=1) >= 0).all()
    assert extent[:, :, 3].max() == 1.0
    phases = vertices.phase.reshape(30, corners, 3)
    assert (phases == phases[:, :1]).all()
    assert len(np.unique(phases[:, 0, 2])) > 20
    assert ((phases >= 0) & (phases < 1)).all()


def test_no_leaves_give_no_vertices():
    skeleton = random_skeleton(4, 60)
    foliage = scatter_leaves(skeleton, 0)
    vertices = spread_over_leaves(skeleton, weigh_wind(skeleton, height=10.0), foliage)
    assert vertices.extent.shape == (0, 4)
    assert vertices.pivot.shape == (0, 2, 3)


def test_wood_that_does_not_know_its_nodes_is_refused():
    skeleton = random_skeleton(4, 10)
    wood = dataclasses.replace(sweep_rings(skeleton), node=None)
    with pytest.raises(InputError, match="node of each vertex"):
        spread_over_wood(skeleton, weigh_wind(skeleton, height=10.0), wood)


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 1000), joints=st.integers(1, 60))
def test_a_skin_is_what_gltf_wants(seed, joints):
    skeleton, rng = random_skeleton(seed, 80), np.random.default_rng(seed)
    armature = bind_joints(skeleton, joints=joints)
    node = rng.integers(0, 80, 200).astype(np.int32)
    around = skeleton.points[node] + rng.normal(0, 0.3, (200, 3)).astype(np.float32)
    joint, weight = skin_vertices(skeleton, armature, node, around.astype(np.float32))
    assert joint.shape == weight.shape == (200, 4)
    assert joint.dtype == np.uint16
    assert (joint[weight == 0] == 0).all()
    assert (np.diff(weight, axis=1) <= 0).all(), "the heaviest first"
    np.testing.assert_allclose(weight.sum(axis=1), 1.0, atol=1e-6)
    for row, shares in zip(joint.tolist(), weight, strict=True):
        used = [number for number, share in zip(row, shares, strict=True) if share > 0]
        assert len(used) == len(set(used)), "each joint once"


def test_a_vertex_at_a_node_is_skinned_as_the_node():
    skeleton = random_skeleton(1, 80)
    armature = bind_joints(skeleton, joints=30)
    node = np.arange(80, dtype=np.int32)
    joint, weight = skin_vertices(skeleton, armature, node, skeleton.points)
    spread = np.zeros((80, len(armature.parent)))
    np.add.at(spread, (node[:, None], joint), weight)
    wanted = np.zeros_like(spread)
    np.add.at(wanted, (node[:, None], armature.joint), armature.weight)
    np.testing.assert_allclose(spread, wanted, atol=1e-5)
