import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.geometry.plane_grid import PlaneGrid
from flowtree.geometry.projection import to_plane
from flowtree.geometry.segment_depth import rods_depth, segment_depth

GRID = PlaneGrid(yaw=90.0, left=-3.0, bottom=-1.0, cell=0.2, columns=30, rows=40)


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10_000), count=st.integers(1, 15), thick=st.floats(0.001, 0.5))
def test_area_is_the_silhouettes(seed, count, thick):
    """Length as it is seen times the diameter, whatever the segment's length and width in cells."""
    rng = np.random.default_rng(seed)
    start, end = (rng.uniform([-1.5, 0.5, -1.5], [1.5, 5, 1.5], (count, 3)) for _ in range(2))
    radius = rng.random(count) * thick
    depth = segment_depth(GRID, start, end, radius, np.arange(count), count)
    seen = np.linalg.norm(to_plane(end, GRID) - to_plane(start, GRID), axis=1)
    assert np.allclose(np.asarray(depth.sum(axis=0)) * GRID.cell**2, 2 * radius * seen)


def test_a_wide_segment_fills_its_rectangle_evenly():
    start, end = np.array([[0.0, 0.0, 0.0]]), np.array([[0.0, 4.0, 0.0]])
    depth = segment_depth(GRID, start, end, np.array([1.0]), np.zeros(1, np.int64), 1).toarray()
    depth = depth.reshape(GRID.columns, GRID.rows)
    across = GRID.left + (np.arange(GRID.columns) + 0.5) * GRID.cell
    up = GRID.bottom + (np.arange(GRID.rows) + 0.5) * GRID.cell
    inside = (np.abs(across) < 0.8)[:, None] & (up > 0.2) & (up < 3.8)
    outside = (np.abs(across) > 1.2)[:, None] | (up < -0.2) | (up > 4.2)
    assert np.allclose(depth[inside], 1.0)
    assert (depth[outside] == 0).all()


def test_what_has_no_length_or_no_width_covers_nothing():
    points = np.array([[0.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.0, 2.0, 0.5]])
    depth = segment_depth(GRID, points[[0, 0]], points[[1, 2]], np.array([0.3, 0.0]), np.arange(2), 2)
    assert depth.sum() == 0
    # A segment toward the camera shows its end alone, which is not counted.
    along = segment_depth(GRID, np.zeros((1, 3)), np.array([[1.0, 0, 0]]), np.ones(1), np.zeros(1, int), 1)
    assert along.sum() == pytest.approx(0, abs=1e-12)


def test_rods_are_the_segments_of_a_tree():
    parent = np.array([-1, 0, 1, 1], np.int32)
    points = np.array([[0, 0, 0], [0, 1, 0], [0, 2, 1], [0, 2, -1]], np.float32)
    radius = np.array([0.3, 0.1, 0.1, 0.3], np.float32)
    depth = rods_depth(GRID, parent, points, radius)
    area = 2 * (0.2 * 1 + 0.1 * np.sqrt(2) + 0.2 * np.sqrt(2))
    assert depth.sum() * GRID.cell**2 == pytest.approx(area, rel=1e-6)
    one_by_one = sum(
        rods_depth(GRID, np.array([-1, 0], np.int32), points[[p, k]], radius[[p, k]])
        for k, p in enumerate(parent)
        if p >= 0
    )
    assert np.allclose(depth, one_by_one)
    assert rods_depth(GRID, parent[:1], points[:1], radius[:1]).sum() == 0
