"""The single pictures of a contact sheet."""

from __future__ import annotations

import dataclasses

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.geometry.projection import plane_to_pixels
from flowtree.model.attractor import AttractorGraph
from flowtree.model.camera import Camera
from flowtree.model.matte import Matte
from flowtree.model.photo import Photo
from flowtree.render.draw_panels import crop_view, draw_difference, draw_graph, draw_matte


def _view(top=20, left=30, bottom=80, right=60, size=(100, 120)):
    """A box of tree in a picture whose red says the row and whose green says the column."""
    rows, columns = size
    row, column = np.mgrid[:rows, :columns]
    rgb = np.stack([row, column, 0 * row], axis=2).astype(np.uint8)
    alpha = np.zeros(size, np.float32)
    alpha[top:bottom, left:right] = 1.0
    camera = Camera(90.0, 0.1, ((left + right) / 2, float(bottom)), columns, rows)
    return Photo("a.jpg", rgb), Matte(alpha, rgb, "automatic"), camera


@settings(deadline=None, max_examples=25)
@given(
    top=st.integers(0, 60),
    left=st.integers(0, 60),
    tall=st.integers(4, 40),
    wide=st.integers(4, 40),
    width=st.integers(1, 200),
    height=st.integers(1, 200),
)
def test_a_panel_fits_its_place_and_shows_the_same_places(top, left, tall, wide, width, height):
    photo, matte, camera = _view(top, left, top + tall, left + wide)
    near, rgb, alpha, unknown = crop_view(photo, matte, camera, width=width, height=height)
    assert rgb.shape[:2] == alpha.shape == (near.height, near.width)
    assert near.width <= width
    assert near.height <= height
    assert unknown is None
    plane = np.array([[0.0, 0.0], [1.0, 2.0]])
    before, after = plane_to_pixels(plane, camera), plane_to_pixels(plane, near)
    shrink = near.metres_per_pixel / camera.metres_per_pixel
    np.testing.assert_allclose((after[1] - after[0]) * shrink, before[1] - before[0])


def test_a_panel_of_nothing_is_the_whole_photo():
    photo, matte, camera = _view()
    empty = dataclasses.replace(matte, alpha=np.zeros_like(matte.alpha))
    near, _, _, _ = crop_view(photo, empty, camera, width=60, height=100)
    assert (near.width, near.height) == (60, 50)


def test_unknown_pixels_are_blue_and_not_compared():
    photo, matte, camera = _view()
    hidden = np.zeros(matte.alpha.shape, bool)
    hidden[:, 40:50] = True
    known = dataclasses.replace(matte, unknown=hidden)
    _, _, alpha, unknown = crop_view(photo, known, camera, width=400, height=400)
    assert 0.1 < unknown.mean() < 0.4
    for picture in (
        draw_matte(alpha, unknown),
        draw_difference(alpha, np.zeros(alpha.shape, np.uint8), unknown),
    ):
        blue = picture[unknown].mean(axis=0)
        assert blue[2] > blue[0]
        assert blue[2] > blue[1]


def test_the_difference_says_who_has_tree():
    ones, zeros = np.ones((1, 1), np.float32), np.zeros((1, 1), np.uint8)
    only_photo, only_tree, both, neither = (
        draw_difference(alpha, drawn, None)[0, 0].astype(int)
        for alpha, drawn in ((ones, zeros), (0 * ones, zeros + 255), (ones, zeros + 255), (0 * ones, zeros))
    )
    assert only_photo[0] > only_photo[2] + 100
    assert only_tree[2] > only_tree[0] + 100
    assert np.ptp(both) == 0
    assert (neither == 255).all()


def test_the_graph_lies_where_its_camera_sees_it():
    graph = AttractorGraph(np.array([-1, 0], np.int32), np.array([[0, 0], [0, 4]], np.float32))
    camera = Camera(0.0, 0.1, (20.0, 50.0), 40, 60)
    pale = draw_graph(np.zeros((60, 40, 3), np.uint8), None, camera)
    drawn = draw_graph(np.zeros((60, 40, 3), np.uint8), graph, camera)
    rows, columns = np.nonzero((drawn != pale).any(axis=2))
    assert abs(rows.min() - 10) <= 2
    assert abs(rows.max() - 50) <= 2
    assert abs(columns.mean() - 19.5) <= 1.0
