from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from flowtree.foliage.make_leaf import make_leaf
from flowtree.levels.seen_area import seen_area
from flowtree.levels.simplify_leaf import simplify_leaf
from flowtree.model.mesh import TreeMesh
from tests.trees import leaf_material, leaf_quad

SHAPES = ["broad", "lanceolate", "needle", "frond", "compound", "blossom"]


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize(("bands", "pieces"), [(1, 1), (2, 1), (2, 2)])
def test_a_leaf_of_few_triangles_shows_what_the_fine_one_does(shape, bands, pieces):
    leaf, material = make_leaf(shape)
    simple = simplify_leaf(leaf, material, bands=bands, pieces=pieces)
    assert len(simple.triangles) <= max(2 * bands * pieces, len(leaf.triangles))
    assert np.isfinite(simple.positions).all()
    assert np.allclose(np.linalg.norm(simple.normals, axis=1), 1.0, atol=1e-5)
    assert ((simple.uvs >= 0) & (simple.uvs <= 1)).all()
    # It stays where the leaf is.
    low, high = leaf.positions.min(axis=0) - 0.12, leaf.positions.max(axis=0) + 0.12
    assert (simple.positions >= low).all()
    assert (simple.positions <= high).all()
    shown = seen_area(simple, material) / seen_area(leaf, material)
    assert shown > (0.6 if shape in ("needle", "frond") else 0.85)
    assert shown < 1.1


@pytest.mark.parametrize("shape", SHAPES)
def test_its_triangles_face_the_way_of_its_normals(shape):
    leaf, material = make_leaf(shape)
    simple = simplify_leaf(leaf, material)
    a, b, c = (simple.positions[simple.triangles[:, k]] for k in range(3))
    facing = np.cross(b - a, c - a)
    assert (np.sum(facing * simple.normals[simple.triangles].mean(axis=1), axis=1) > 0).all()


def test_a_leaf_that_is_simple_stays_as_it_is():
    leaf = leaf_quad()
    assert simplify_leaf(leaf, leaf_material()) is leaf


def test_a_leaf_that_shows_nothing_stays_as_it_is():
    leaf, material = make_leaf("broad")
    none = material.base_color.copy()
    none[:, :, 3] = 0
    assert simplify_leaf(leaf, dataclasses.replace(material, base_color=none)) is leaf


def test_the_seen_area_of_a_flat_square_is_half_of_it():
    square = TreeMesh(
        positions=np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], np.float32),
        normals=np.tile(np.array([0, 0, 1], np.float32), (4, 1)),
        uvs=np.zeros((4, 2), np.float32),
        triangles=np.array([[0, 1, 2], [0, 2, 3]], np.int32),
    )
    opaque = dataclasses.replace(leaf_material(), base_color=np.full((2, 2, 3), 99, np.uint8))
    assert seen_area(square, opaque) == pytest.approx(0.5, rel=0.08)
