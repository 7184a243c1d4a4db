"""Merged leaves are the leaves, placed one by one; their normals lean outward and stay on their side."""

from __future__ import annotations

import dataclasses

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from flowtree.export.merge_leaves import merge_leaves
from flowtree.geometry.outward_directions import outward_directions
from flowtree.model.foliage import Foliage
from flowtree.model.mesh import TreeMesh
from tests.trees import hand_made_skeleton, scatter_leaves


def rounded(foliage: Foliage, share: float) -> TreeMesh:
    return merge_leaves(dataclasses.replace(foliage, rounding=share))


def leaves(count: int, seed: int) -> Foliage:
    return scatter_leaves(hand_made_skeleton(), count, seed)


@settings(max_examples=20, deadline=None)
@given(count=st.integers(1, 30), seed=st.integers(0, 1000))
def test_merging_all_equals_placing_each(count: int, seed: int) -> None:
    foliage = leaves(count, seed)
    merged = merge_leaves(dataclasses.replace(foliage, rounding=0.0))
    size = len(foliage.leaf.positions)
    for k in range(count):
        turn = Rotation.from_quat(foliage.rotation[k].astype(np.float64)).as_matrix()
        run = slice(k * size, (k + 1) * size)
        expected = foliage.scale[k] * foliage.leaf.positions @ turn.T + foliage.position[k]
        np.testing.assert_allclose(merged.positions[run], expected, atol=2e-6)
        np.testing.assert_allclose(merged.normals[run], foliage.leaf.normals @ turn.T, atol=2e-6)
        np.testing.assert_array_equal(merged.colors[run], np.tile(foliage.color[k], (size, 1)))
        faces = merged.triangles[2 * k : 2 * k + 2]
        np.testing.assert_array_equal(faces - k * size, foliage.leaf.triangles)


@settings(max_examples=20, deadline=None)
@given(count=st.integers(1, 60), seed=st.integers(0, 1000), share=st.floats(0, 1))
def test_bent_normals_are_unit_and_stay_on_their_side(count: int, seed: int, share: float) -> None:
    foliage = leaves(count, seed)
    own, bent = (rounded(foliage, value).normals for value in (0.0, share))
    np.testing.assert_allclose(np.linalg.norm(bent, axis=1), 1.0, atol=1e-5)
    assert ((own * bent).sum(axis=1) > -1e-5).all()


def test_normals_seen_from_outside_look_outward() -> None:
    foliage = leaves(400, 0)
    merged = merge_leaves(foliage)
    places = merged.positions.reshape(400, 4, 3).mean(axis=1)
    outward = outward_directions(places)
    normals, own = merged.normals.reshape(400, 4, 3)[:, 0], rounded(foliage, 0.0).normals[::4]
    # A renderer flips the normal of a side seen from behind.
    seen = np.where(((own * outward).sum(axis=1) < 0)[:, None], -normals, normals)
    own_seen = np.where(((own * outward).sum(axis=1) < 0)[:, None], -own, own)
    unit = outward / np.linalg.norm(outward, axis=1, keepdims=True)
    assert ((seen * unit).sum(axis=1) > 0.49).all()
    assert ((seen * unit).sum(axis=1) >= (own_seen * unit).sum(axis=1) - 1e-5).all()


def test_one_leaf_is_left_as_it_is() -> None:
    foliage = leaves(1, 5)
    np.testing.assert_array_equal(merge_leaves(foliage).normals, rounded(foliage, 0.0).normals)


def test_colours_of_the_shape_and_of_the_leaf_multiply() -> None:
    foliage = leaves(2, 0)
    shape = dataclasses.replace(foliage.leaf, colors=np.array([[0.5, 1, 0]] * 4, np.float32))
    merged = merge_leaves(dataclasses.replace(foliage, leaf=shape))
    np.testing.assert_allclose(merged.colors[::4], foliage.color * [0.5, 1, 0])


def test_no_leaf_is_an_empty_mesh() -> None:
    merged = merge_leaves(leaves(0, 0))
    assert merged.positions.shape == merged.normals.shape == merged.colors.shape == (0, 3)
    assert merged.triangles.shape == (0, 3)
    assert merged.uvs.shape == (0, 2)
