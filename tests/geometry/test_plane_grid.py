import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.geometry.footprint_means import OPAQUE
from flowtree.geometry.plane_grid import PlaneGrid, seen_depth, splat_matrix, stem_cells
from flowtree.geometry.projection import view_axes
from flowtree.model.camera import Camera

GRID = PlaneGrid(yaw=30.0, left=-2.0, bottom=0.0, cell=0.25, columns=16, rows=20)


def in_plane(grid, u, v, depth=0.0):
    """World points that a view sees at (u, v) of its plane."""
    right, up, toward = view_axes(grid.yaw)
    return np.multiply.outer(u, right) + np.multiply.outer(v, up) + depth * toward


@settings(max_examples=25, deadline=None)
@given(
    shape=st.tuples(st.integers(1, 30), st.integers(1, 30)),
    foot=st.tuples(st.floats(-5, 40), st.floats(-5, 40)),
    cell=st.floats(0.05, 2.0),
    seed=st.integers(0, 1000),
)
def test_the_grid_covers_the_picture_and_keeps_its_alpha(shape, foot, cell, seed):
    alpha = np.random.default_rng(seed).random(shape).astype(np.float32) * np.float32(0.9)
    view = Camera(0.0, 0.1, foot, shape[1], shape[0])
    grid, depth = seen_depth(alpha, view, cell=cell)
    assert depth.shape == (grid.columns * grid.rows,)
    assert (depth >= 0).all()
    assert grid.left <= -foot[0] * 0.1 + 1e-9
    assert grid.left + grid.columns * cell >= (shape[1] - foot[0]) * 0.1 - 1e-9
    assert grid.bottom <= (foot[1] - shape[0]) * 0.1 + 1e-9
    assert grid.bottom + grid.rows * cell >= foot[1] * 0.1 - 1e-9
    assert -np.expm1(-depth).sum() * cell**2 == pytest.approx(alpha.sum(dtype=float) * 0.01, rel=1e-5)


def test_the_axes_cross_the_grid_between_cells():
    """So that a row begins at the ground whatever the picture's margins."""
    grid, _ = seen_depth(np.ones((33, 21), np.float32), Camera(0.0, 0.1, (9.3, 29.7), 21, 33), cell=0.23)
    assert (grid.left / grid.cell) % 1 == pytest.approx(0, abs=1e-9)
    assert (grid.bottom / grid.cell) % 1 == pytest.approx(0, abs=1e-9)


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10_000), count=st.integers(1, 20))
def test_splats_keep_area_and_centre_inside(seed, count):
    rng = np.random.default_rng(seed)
    u, v = rng.uniform(-1.7, 1.7, count), rng.uniform(0.3, 4.6, count)
    areas = rng.random(count)
    depth = splat_matrix(GRID, in_plane(GRID, u, v, 3.0), areas, np.arange(count), count).toarray()
    assert np.allclose(depth.sum(axis=0) * GRID.cell**2, areas)
    column, row = np.divmod(np.arange(GRID.columns * GRID.rows), GRID.rows)
    share = depth / depth.sum(axis=0)
    assert np.allclose(share.T @ (GRID.left + (column + 0.5) * GRID.cell), u)
    assert np.allclose(share.T @ (GRID.bottom + (row + 0.5) * GRID.cell), v)
    assert (np.count_nonzero(depth, axis=0) <= 4).all()


def test_splats_of_one_thing_add_up_and_those_outside_are_lost():
    points = in_plane(GRID, np.array([0.0, 0.1, 90.0]), np.array([1.0, 1.1, 1.0]))
    matrix = splat_matrix(GRID, points, np.array([1.0, 2.0, 4.0]), np.array([0, 0, 1]), 3)
    assert np.allclose(np.asarray(matrix.sum(axis=0)) * GRID.cell**2, [3.0, 0.0, 0.0])
    nothing = splat_matrix(GRID, np.zeros((0, 3)), np.zeros(0), np.zeros(0, np.int64), 0)
    assert nothing.shape == (320, 0)


def rows_of(grid, widths):
    """Depths of rows that hold opaque cells of these widths [m]."""
    depth = np.zeros((grid.columns, grid.rows))
    for row, width in enumerate(widths):
        depth[: round(width / grid.cell), row] = 20.0
    return depth.ravel()


def test_the_stem_ends_where_the_crown_begins():
    widths = [0.5] * 7 + [3.0] * 13
    depth = rows_of(GRID, widths)
    held = depth.reshape(GRID.columns, GRID.rows) > 0
    narrow = stem_cells(GRID, depth, 1.0).reshape(GRID.columns, GRID.rows)
    assert (narrow == (np.arange(20) < 7))[held].all()


def test_a_flare_or_a_tuft_is_no_crown():
    widths = [2.0, 0.5, 2.0, 0.5, 0.5, 0.5, 0.5] + [3.0] * 13
    depth = rows_of(GRID, widths)
    held = depth.reshape(GRID.columns, GRID.rows) > 0
    narrow = stem_cells(GRID, depth, 1.0).reshape(GRID.columns, GRID.rows)
    assert (narrow == (np.arange(20) < 7))[held].all()


def test_a_low_bough_is_none_of_the_stem():
    depth = rows_of(GRID, [0.5] * 10 + [3.0] * 10).reshape(GRID.columns, GRID.rows)
    depth[round(2.5 / GRID.cell) : round(2.75 / GRID.cell), 5] = 20.0
    narrow = stem_cells(GRID, depth.ravel(), 1.0).reshape(GRID.columns, GRID.rows)
    assert not narrow[round(2.5 / GRID.cell), 5]
    assert narrow[0, :10].all()


def test_a_crown_down_to_the_ground_has_no_stem_rows_but_those_below_the_ground():
    grid = PlaneGrid(0.0, -2.0, -1.0, 0.25, 16, 20)
    narrow = stem_cells(grid, rows_of(grid, [3.0] * 20), 1.0).reshape(16, 20)
    assert (narrow == (np.arange(20) < 4)).all()
    high = PlaneGrid(0.0, -2.0, -50.0, 0.25, 16, 20)  # all of it below the ground
    assert stem_cells(high, rows_of(high, [3.0] * 20), 1.0).all()


def test_a_matte_is_capped_where_it_is_opaque():
    _, depth = seen_depth(np.ones((8, 8), np.float32), Camera(0.0, 1.0, (4.0, 8.0), 8, 8), cell=1.0)
    assert np.allclose(depth, -np.log(1 - OPAQUE))
