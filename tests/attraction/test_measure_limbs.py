import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import ndimage

from flowtree.attraction.cut_working_grid import WorkingGrid, cut_working_grid
from flowtree.attraction.measure_limbs import LimbWidths, measure_limbs
from flowtree.attraction.trace_attractor_graph import trace_attractor_graph
from flowtree.geometry.polylines import nearest_on_segments
from flowtree.geometry.projection import plane_to_pixels
from flowtree.model.camera import Camera
from flowtree.model.matte import Matte
from flowtree.model.photo import Photo

# A stem, three limbs from its top, and a limb from each of those, as they stand in the picture [pixels].
LIMBS = [
    ((200, 500), (200, 330), 14),
    ((200, 330), (80, 60), 9),
    ((200, 330), (215, 40), 9),
    ((200, 330), (330, 90), 8),
    ((150, 217), (60, 190), 5),
    ((208, 185), (270, 110), 5),
    ((265, 210), (370, 220), 5),
]


def bare_tree():
    fine = np.zeros((512 * 4, 400 * 4), np.uint8)
    for start, end, width in LIMBS:
        cv2.line(fine, [4 * k for k in start], [4 * k for k in end], 255, 4 * width)
    alpha = cv2.resize(fine, (400, 512), interpolation=cv2.INTER_AREA).astype(np.float32) / 255
    rgb = np.full((512, 400, 3), 90, np.uint8)
    return Photo("bare", rgb), Matte(alpha, rgb, "automatic"), Camera(0.0, 0.02, (200.0, 500.0), 400, 512)


def matte_of(opaque):
    return Matte(opaque.astype(np.float32), np.zeros((*opaque.shape, 3), np.uint8), "automatic")


def test_every_limb_is_followed_along_its_middle_and_measured():
    photo, matte, camera = bare_tree()
    graph = trace_attractor_graph(photo, matte, camera, leafy=False)
    nodes = plane_to_pixels(graph.points, camera)
    for start, end, width in LIMBS:
        share = np.linspace(0.15, 0.9, 30)[:, None]
        line = np.array(start) * (1 - share) + np.array(end) * share
        _, nearest = nearest_on_segments(line[:, None], nodes[graph.parent[1:]][None], nodes[1:][None])
        assert np.linalg.norm(nearest - line[:, None], axis=2).min(axis=1).max() < 0.5 * width + 2
        beside = np.linalg.norm(nodes[:, None] - line[None], axis=2).min(axis=1) < 2
        half = graph.half_width[beside] / camera.metres_per_pixel
        assert np.nanmedian(half) == pytest.approx(width / 2, abs=0.75)


def test_a_leafy_tree_is_measured_only_where_the_stems_colour_shows():
    _, matte, camera = bare_tree()
    rgb = np.where(np.arange(512)[:, None, None] > 340, [110, 70, 40], [60, 150, 50]).astype(np.uint8)
    rgb = np.broadcast_to(rgb, (512, 400, 3)).copy()
    rgb[(matte.alpha > 0.1) & (np.hypot(*np.mgrid[-150:362, -330:70]) < 110)] = 110, 70, 40  # a limb's end
    leafy = Photo("leafy", rgb)
    graph = trace_attractor_graph(leafy, Matte(matte.alpha, rgb, "automatic"), camera)
    pixels = plane_to_pixels(graph.points, camera)
    green = (rgb[tuple(np.floor(pixels[:, ::-1]).astype(int).clip(0, (511, 399)).T)] == 150).any(axis=1)
    assert np.isnan(graph.half_width[green]).mean() > 0.9
    assert np.nanmax(graph.half_width[pixels[:, 1] > 360]) == pytest.approx(0.14, abs=0.02)


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 10_000), share=st.floats(0, 1), tall=st.floats(1, 400))
def test_nothing_is_wider_than_the_disc_that_covers_it(seed, share, tall):
    noise = ndimage.gaussian_filter(np.random.default_rng(seed).standard_normal((48, 40)), 2)
    shape = noise <= np.quantile(noise, share)
    made = measure_limbs(matte_of(shape), tall)
    exact = ndimage.distance_transform_edt(np.pad(shape, 1))[1:-1, 1:-1]
    assert np.allclose(made.depth, exact, rtol=0.03, atol=0.06)  # the chamfer distance is nearly the true one
    assert (made.half >= made.depth).all()
    assert (made.half[~shape] == 0).all()
    y, x = np.indices(shape.shape)
    for row, column in np.argwhere(made.half > made.depth)[:50]:
        near = np.hypot(y - row, x - column) <= made.half[row, column] * 1.05 + 0.1
        assert made.depth[near].max() >= made.half[row, column] * 0.99


def test_outside_the_picture_nothing_is_measured():
    photo, matte, camera = bare_tree()
    made = measure_limbs(matte, 460)
    places = np.array([[-5.0, 20.0], [500.0, 20.0], [20.0, 900.0], [200.0, 400.0]])
    half = made.at(places)
    assert np.isnan(half[:3]).all()
    assert half[3] == pytest.approx(7, abs=0.75)
    grid = cut_working_grid(photo, matte, np.array([camera.foot]), 240)
    middle, width = made.on_grid(grid)
    assert middle.shape == width.shape == grid.alpha.shape
    assert middle.max() <= 1


@settings(max_examples=25, deadline=None)
@given(
    scale=st.floats(0.2, 3.0),
    corner=st.tuples(st.integers(-8, 12), st.integers(-8, 12)),
    size=st.tuples(st.integers(1, 12), st.integers(1, 12)),
    seed=st.integers(0, 99),
)
def test_a_cell_gets_its_clearest_pixel(scale, corner, size, seed):
    """As found pixel by pixel; a fine grid has cells without any."""
    half = np.random.default_rng(seed).uniform(0.0, 3.0, (14, 11)).astype(np.float32)
    depth = (half * np.random.default_rng(seed + 1).uniform(0.0, 1.0, half.shape)).astype(np.float32)
    grid = WorkingGrid(np.ones(size, np.float32), np.zeros((*size, 3), np.float32), scale, corner, 40.0)
    clear, thick = np.zeros(size), np.zeros(size)
    for row, column in np.ndindex(*half.shape):
        x, y = (int(np.floor((p + 0.5 - c) * scale)) for p, c in zip((column, row), corner, strict=True))
        if 0 <= x < size[1] and 0 <= y < size[0]:
            clear[y, x] = max(clear[y, x], depth[row, column] / max(half[row, column], 1e-6))
            thick[y, x] = max(thick[y, x], half[row, column] * scale / 40.0)
    for found, slow in zip(LimbWidths(depth, half).on_grid(grid), (clear, thick), strict=True):
        assert np.allclose(found, slow, rtol=1e-6)
