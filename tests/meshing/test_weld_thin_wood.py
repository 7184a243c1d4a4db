"""Welding thin wood takes vertices away, and nothing else."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.geometry.closed_surfaces import is_closed, weld
from flowtree.meshing.sweep_rings import sweep_rings
from flowtree.meshing.weld_thin_wood import weld_thin_wood
from flowtree.params import MeshingParams
from tests.skeletons import random_skeleton


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 999), sides=st.sampled_from([3, 4, 8]), share=st.sampled_from([0.0, 0.3, 2.0]))
def test_places_triangles_and_normals_stay(seed, sides, share):
    skeleton = random_skeleton(seed, 60)
    wood = sweep_rings(skeleton, params=MeshingParams(sides=sides))
    welded = weld_thin_wood(wood, skeleton, radius=share * float(skeleton.radius.max()))
    np.testing.assert_array_equal(welded.positions[welded.triangles], wood.positions[wood.triangles])
    turned = (welded.normals[welded.triangles] * wood.normals[wood.triangles]).sum(axis=2)
    assert turned.min() > 0.97
    np.testing.assert_array_equal(welded.node[welded.triangles], wood.node[wood.triangles])
    thick = skeleton.radius[wood.node[wood.triangles]] > share * skeleton.radius.max()
    np.testing.assert_array_equal(welded.uvs[welded.triangles][thick], wood.uvs[wood.triangles][thick])
    corners = np.sort(welded.triangles, axis=1)
    assert len(np.unique(corners, axis=0)) == len(corners)
    assert is_closed(weld(wood.positions, wood.triangles)) == is_closed(
        weld(welded.positions, welded.triangles)
    )
    if share == 0.0:
        assert len(welded.positions) == len(wood.positions)
    if share == 2.0:
        assert len(welded.positions) < len(wood.positions)


@pytest.mark.parametrize("change", [{"node": None}, {"tangents": None}])
def test_wood_that_knows_less_is_taken_as_it_is(change):
    skeleton = random_skeleton(1, 20)
    wood = dataclasses.replace(sweep_rings(skeleton), **change)
    welded = weld_thin_wood(wood, skeleton, radius=1e9)
    assert (welded is wood) == (wood.node is None)
    assert (welded.tangents is None) == (wood.tangents is None)
