from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.geometry.cover_canvas import FINE, lay_canvas
from flowtree.geometry.footprint_means import footprint_means
from flowtree.geometry.projection import foreshorten, growth
from flowtree.model.camera import Camera

CAMERA = Camera(30.0, 0.05, (30.0, 55.0), 60, 60)
PIXEL = 0.2 / FINE


def canvas_of(alpha=None, camera=CAMERA):
    picture = np.zeros((camera.height, camera.width), np.float32) if alpha is None else alpha
    return lay_canvas(picture, None, camera, cell=0.2)


def test_wanted_is_the_mean_over_each_cell():
    alpha = np.random.default_rng(0).random((60, 60)).astype(np.float32)
    canvas = canvas_of(alpha)
    grid = canvas.grid
    box = {"left": grid.left, "bottom": grid.bottom, "columns": grid.columns, "rows": grid.rows}
    assert np.allclose(canvas.wanted, footprint_means(alpha, CAMERA, cell=0.2, **box), atol=1e-6)
    assert canvas.wanted.sum() * 0.2**2 == pytest.approx(alpha.sum() * 0.05**2, rel=1e-5)
    # Cells are counted from the foot.
    assert grid.left / 0.2 == pytest.approx(round(grid.left / 0.2))


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10_000), yaw=st.floats(0, 360))
def test_cells_and_pixels_belong_together(seed, yaw):
    random = np.random.default_rng(seed)
    canvas = canvas_of(camera=Camera(yaw, 0.05, (30.0, 55.0), 60, 60))
    cells = random.random(canvas.wanted.shape).astype(np.float32)
    assert np.allclose(canvas.cell_means(canvas.spread(cells)), cells, atol=1e-6)
    points = random.uniform(-3, 4, (200, 3))
    flat = canvas.flat(points)
    pixels = canvas.index(flat[:, 0], flat[:, 1])
    column, row = (np.floor(flat[:, k] / FINE).astype(int) for k in (0, 1))
    beside = (column < 0) | (column >= canvas.grid.columns) | (row < 0) | (row >= canvas.grid.rows)
    assert np.array_equal(beside, pixels == len(canvas.depth) - 1)
    expected = np.where(beside, canvas.wanted.size, column * canvas.grid.rows + row)
    assert np.array_equal(canvas.cell_index(pixels), expected)
    assert (canvas.spread(cells)[pixels[beside]] == 0).all()


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10_000))
def test_an_eye_sees_near_things_larger_and_where_they_are_foreshortened_to(seed):
    random = np.random.default_rng(seed)
    near = replace(CAMERA, distance=6.0, eye=1.0)
    from_near, parallel = canvas_of(camera=near), canvas_of()
    start = random.uniform((-0.5, 0.6, -0.5), (0.5, 1.5, 0.5), (1, 3))
    larger = float(growth(start, near)[0])
    points = random.uniform((-0.5, 0.5, -0.5), (0.5, 1.5, 0.5), (50, 3))
    assert np.allclose(from_near.flat(points), parallel.flat(foreshorten(points, near)), atol=1e-4)
    patch = (start, np.array([[0.2, 0, 0]]), np.array([[0, 0.2, 0]]), np.array([0.001]))
    seen, flat = (c.patch_covers(*patch, samples=(3, 3)).sum() for c in (from_near, parallel))
    assert seen == pytest.approx(larger**2 * flat, rel=1e-4)
    rod = (start, start + np.array([[0, 0.02, 0]]), np.array([0.002]), np.array([0]), 1)
    seen, flat = (c.rod_covers(*rod).sum() for c in (from_near, parallel))
    assert seen == pytest.approx(larger**2 * flat, rel=0.01)


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10_000), radius=st.floats(0.001, 0.2))
def test_rods_cover_their_silhouettes(seed, radius):
    random = np.random.default_rng(seed)
    start, end = random.uniform((-0.8, 0.6, -0.8), (0.8, 2.0, 0.8), (2, 5, 3))
    canvas = canvas_of()
    covers = canvas.rod_covers(start, end, np.full(5, radius), np.array([0, 0, 2, 2, 2]), 3)
    length = np.linalg.norm(canvas.turn(end - start), axis=1) * PIXEL
    area = np.bincount([0, 0, 2, 2, 2], 2 * radius * length, minlength=3)
    assert covers.shape == (3, len(canvas.depth))
    assert (covers.data <= np.float32(0.99)).all()
    assert np.all(covers.sum(axis=1) * PIXEL**2 <= area * (1 + 1e-4))
    assert np.all(covers.sum(axis=1) * PIXEL**2 >= 0.95 * area)


def test_patches_cover_their_area_where_they_are():
    canvas = canvas_of()
    centre, along, aside = np.array([[0.3, 1.0, 0.2]]), np.array([[0.0, 0.4, 0.0]]), np.array([[0.1, 0, 0]])
    cover = canvas.patch_covers(centre, along, aside, np.array([0.015]), samples=(4, 3))
    assert cover.sum() * PIXEL**2 == pytest.approx(0.015, rel=0.01)
    flat = canvas.flat(centre)
    cell = canvas.cell_index(canvas.index(flat[:, 0], flat[:, 1]))
    assert cell[0] in canvas.cell_index(cover.indices)


def test_an_opaque_limb_is_opaque_and_a_thin_one_covers_its_share():
    canvas = canvas_of()
    points = np.array([[0, 0.2, 0], [0, 2.2, 0]])
    parent = np.array([-1, 0])
    thick = canvas.with_tree(parent, points, np.array([0.5, 0.5])).shown()
    thin = canvas.with_tree(parent, points, np.array([0.005, 0.005])).shown()
    assert thick.max() > 0.98
    assert thin.sum() * 0.2**2 == pytest.approx(2 * 0.005 * 2.0, rel=0.03)
    assert canvas.shown().max() == 0


def tree_of_rods(start, end, radius):
    """Parents, points and radii of rods that hang on nothing."""
    count = len(start)
    parent = np.concatenate([np.full(count, -1), np.arange(count)])
    return parent, np.concatenate([start, end]), np.full(2 * count, radius)


@settings(max_examples=25, deadline=None)
@given(tilt=st.floats(0, 180), radius=st.floats(0.03, 0.1), shift=st.floats(0, PIXEL))
def test_a_limb_has_no_holes(tilt, radius, shift):
    canvas = canvas_of(camera=Camera(0.0, 0.05, (30.0, 55.0), 60, 60))
    way = np.array([np.cos(np.radians(tilt)), np.sin(np.radians(tilt)), 0.0])
    start = np.array([[shift, 0.9, 0.0]])
    shown = canvas.with_tree(*tree_of_rods(start, start + 1.2 * way, radius)).shown()
    assert shown.sum() * 0.2**2 >= 0.8 * 2 * radius * 1.2


@pytest.mark.parametrize("count", [40, 400, 1500])
def test_thin_branches_that_cross_hide_each_other(count):
    random = np.random.default_rng(count)
    canvas = canvas_of(camera=Camera(0.0, 0.05, (30.0, 55.0), 60, 60))
    low, high = (-0.8, 0.4, 0.0), (0.8, 2.0, 0.0)
    start = random.uniform(low, high, (count, 3))
    end = np.clip(start + random.normal(0, 0.1, (count, 3)) * (1, 1, 0), low, high)
    shown = canvas.with_tree(*tree_of_rods(start, end, 0.008)).shown().sum() * 0.2**2
    places = random.uniform(low, high, (20_000, 3))
    along = end - start
    hit = np.zeros(len(places), np.bool_)
    for one, way in zip(start, along, strict=True):
        length = np.linalg.norm(way)
        share = (places - one) @ way / length**2
        hit |= (np.abs(np.cross(places - one, way / length)[:, 2]) < 0.008) & (share >= 0) & (share <= 1)
    assert shown == pytest.approx(hit.mean() * 1.6**2, rel=0.05)
