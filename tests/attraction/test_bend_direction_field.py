import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.attraction.bend_direction_field import bend_direction_field
from flowtree.errors import InputError
from flowtree.geometry.projection import pixels_to_plane
from flowtree.model.camera import Camera
from flowtree.model.edit import PaintedEdit
from flowtree.model.field import DirectionField

CAMERA = Camera(0.0, 0.1, (50.0, 100.0), 100, 100)


def field():
    vectors = np.zeros((40, 40, 2), np.float32)
    vectors[..., 1] = -1.0
    return DirectionField(vectors, np.array([-5, 0], np.float32), np.array([0.25, 0.25], np.float32), 0.0)


def place():
    steps = (np.arange(40) + 0.5) * 0.25
    return np.stack(np.meshgrid(steps - 5.0, steps), axis=2)


def test_nothing_painted_is_the_same_field():
    before = field()
    assert bend_direction_field(before, CAMERA, PaintedEdit()) is before


def test_the_stroke_rules_on_it_and_nothing_changes_beyond_its_reach():
    stroke = np.array([[20.0, 50.0], [80.0, 50.0]], np.float32)  # to the right, 5 m up
    before = field()
    after = bend_direction_field(before, CAMERA, PaintedEdit(directions=(stroke,), reach=(15.0,)))
    line = pixels_to_plane(stroke, CAMERA)
    at = place()
    nearest = np.stack([np.clip(at[..., 0], *line[:, 0]), np.full((40, 40), 5.0)], axis=2)
    distance = np.linalg.norm(at - nearest, axis=2)
    beyond = distance >= 1.5
    assert after.vectors[beyond].tobytes() == before.vectors[beyond].tobytes()
    assert (after.vectors[distance < 0.2] @ [1.0, 0.0] > 0.99).all()
    column = after.vectors[20:, 20, 0]
    assert (np.diff(column) <= 1e-6).all()
    assert np.allclose(np.linalg.norm(after.vectors, axis=2), 1.0, atol=1e-5)
    assert (before.vectors == field().vectors).all()


def test_a_stroke_against_the_field_wins_where_both_cancel():
    stroke = np.array([[50.0, 90.0], [50.0, 10.0]], np.float32)
    after = bend_direction_field(field(), CAMERA, PaintedEdit(directions=(stroke,), reach=(20.0,)))
    assert np.isfinite(after.vectors).all()
    assert after.vectors[20, 20, 1] > 0.9


def test_a_stroke_finer_than_the_grid_still_bends_it():
    stroke = np.array([[20.0, 50.0], [80.0, 50.0]], np.float32)
    after = bend_direction_field(field(), CAMERA, PaintedEdit(directions=(stroke,), reach=(0.01,)))
    assert (after.vectors != field().vectors).any()


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 2**16), count=st.integers(1, 4))
def test_random_strokes_leave_unit_vectors(seed, count):
    rng = np.random.default_rng(seed)
    strokes = tuple(rng.uniform(-30, 130, (rng.integers(2, 6), 2)).astype(np.float32) for _ in range(count))
    edit = PaintedEdit(directions=strokes, reach=tuple(rng.uniform(0.1, 40, count)))
    after = bend_direction_field(field(), CAMERA, edit)
    assert np.allclose(np.linalg.norm(after.vectors, axis=2), 1.0, atol=1e-5)


@pytest.mark.parametrize(
    ("strokes", "reach", "rule"),
    [
        ((np.zeros((2, 2)),), (3.0,), "two different points"),
        ((np.array([[0.0, 0.0], [np.nan, 1.0]]),), (3.0,), "finite"),
        ((np.array([[0.0, 0.0], [1.0, 1.0]]),), (0.0,), "reach"),
        ((np.array([[0.0, 0.0], [1.0, 1.0]]),), (), "one reach"),
    ],
)
def test_bad_strokes_are_named(strokes, reach, rule):
    with pytest.raises(InputError, match=rule):
        bend_direction_field(field(), CAMERA, PaintedEdit(directions=strokes, reach=reach))
