import numpy as np
import pytest

from flowtree.geometry.find_painted import find_directed, find_painted
from flowtree.geometry.stroke_share import stroke_share
from flowtree.model.camera import Camera
from flowtree.model.edit import PaintedEdit

CAMERAS = [Camera(yaw, 0.01, (100.0, 190.0), 200, 200) for yaw in (0.0, 90.0)]
NOTHING = PaintedEdit()


def square(left, top, size=20):
    paint = np.zeros((200, 200), np.float32)
    paint[top : top + size, left : left + size] = 1.0
    return paint


def test_what_is_behind_paint_is_painted_however_far():
    at = np.array([[0.1, 1.0, z] for z in (-50.0, 0.0, 50.0)])
    places = find_painted(at, CAMERAS, [PaintedEdit(erase=square(100, 80)), NOTHING])
    assert places.taken.all()
    assert not places.added.any()
    places = find_painted(at[:, ::-1] * [1, 1, -1], CAMERAS, [NOTHING, PaintedEdit(add=square(100, 80))])
    assert places.added.all()
    assert not places.taken.any()


def test_beside_the_paint_and_beside_the_picture_nothing_is_painted():
    at = np.array([[0.4, 1.0, 0.0], [0.1, 1.6, 0.0], [-0.1, 1.0, 0.0], [9.0, 1.0, 0.0], [0.1, -50.0, 0.0]])
    edit = PaintedEdit(erase=square(100, 80), add=square(100, 80))
    assert not find_painted(at, CAMERAS, [edit, NOTHING]).anyhow.any()


def test_a_direction_counts_within_its_reach():
    edit = PaintedEdit(directions=(np.array([[60, 90], [140, 90]], np.float32),), reach=(10.0,))
    at = np.array([[0.0, 1.0, 3.0], [0.0, 1.05, 0.0], [0.0, 1.12, 0.0], [0.6, 1.0, 0.0]])
    assert find_directed(at, CAMERAS, [edit, NOTHING]).tolist() == [True, True, False, False]
    assert find_painted(at, CAMERAS, [edit, NOTHING]).taken.tolist() == [True, True, False, False]


def test_a_stroke_weighs_all_on_it_half_at_half_its_reach_and_nothing_beyond():
    places = np.array([[0.0, 0.0], [0.5, 1.0], [0.5, 2.0], [0.5, 2.5], [4.0, 0.0]])
    share, tangent = stroke_share(places, [np.array([[0.0, 0.0], [1.0, 0.0]])], [2.0])
    assert share == pytest.approx([1.0, 0.5, 0.0, 0.0, 0.0])
    assert tangent[:2].tolist() == [[1.0, 0.0], [1.0, 0.0]]
    assert not tangent[2:].any()
