from __future__ import annotations

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.geometry.coarse_hull import coarse_hull


def check_hull(positions, triangles):
    mesh = trimesh.Trimesh(positions, triangles, process=False)
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    assert mesh.volume > 0
    return mesh


@settings(max_examples=25, deadline=None)
@given(
    seed=st.integers(0, 10_000),
    count=st.integers(4, 400),
    corners=st.integers(4, 40),
    flat=st.sampled_from([1.0, 0.1, 1e-2]),
)
def test_it_is_small_convex_and_holds_nearly_all(seed, count, corners, flat):
    points = np.random.default_rng(seed).normal(size=(count, 3)) * [1, 1, flat]
    positions, triangles = coarse_hull(points, corners=corners)
    mesh = check_hull(positions, triangles)
    assert len(triangles) <= 2 * corners - 4
    height = np.sum((points[:, None] - mesh.triangles_center) * mesh.face_normals, axis=2).max(axis=1)
    assert (height <= 1e-4).mean() >= 0.99
    around = np.sum((positions[:, None] - mesh.triangles_center) * mesh.face_normals, axis=2).max(axis=1)
    assert around.max() <= 1e-4, "convex"


def test_few_corners_come_near_the_true_hull():
    points = np.random.default_rng(0).normal(size=(5000, 3))
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    volume = check_hull(*coarse_hull(points, corners=34)).volume
    assert 0.8 * 4.19 < volume < 1.35 * 4.19


@pytest.mark.parametrize(
    "points",
    [
        np.zeros((1, 3)),
        np.array([[0.0, 1, 0], [0, 2, 0]]),
        np.stack([np.zeros(9), np.arange(9.0), np.zeros(9)], axis=1),
        np.random.default_rng(0).normal(size=(50, 3)) * [1, 1, 0],
    ],
    ids=["a place", "two", "a line", "a plane"],
)
def test_flat_clouds_get_a_thin_body(points):
    positions, triangles = coarse_hull(points)
    check_hull(positions, triangles)
    reach = np.ptp(points, axis=0).max() or 1.0
    assert (positions.min(axis=0) >= points.min(axis=0) - 0.1 * reach).all()
    assert (positions.max(axis=0) <= points.max(axis=0) + 0.1 * reach).all()


def test_a_plane_with_one_bump():
    points = np.random.default_rng(0).normal(size=(200, 3)) * [1, 1, 0]
    points[7, 2] = 0.5
    positions, triangles = coarse_hull(points, corners=30)
    check_hull(positions, triangles)
    assert positions[:, 2].max() > 0.4
