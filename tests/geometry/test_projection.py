import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flowtree.geometry.projection import (
    Viewpoint,
    foreshorten,
    from_plane,
    growth,
    lines_of_sight,
    to_plane,
    view_axes,
)

SIGHTS = st.builds(
    Viewpoint,
    yaw=st.floats(-360, 360),
    distance=st.one_of(st.just(math.inf), st.floats(15, 100)),
    eye=st.floats(0, 5),
)
PLACES = st.integers(0, 1000).map(lambda seed: np.random.default_rng(seed).uniform(-6, 6, (20, 3)))


@given(sight=SIGHTS, points=PLACES)
def test_a_place_and_its_depth_are_seen_and_found_again(sight, points):
    depth = points @ view_axes(sight.yaw)[2]
    assert np.allclose(from_plane(to_plane(points, sight), depth, sight), points, atol=1e-9)


@given(sight=SIGHTS, points=PLACES)
def test_the_plane_through_the_axis_is_seen_as_it_is(sight, points):
    right, up, _ = view_axes(sight.yaw)
    flat = points[:, :2]
    assert np.allclose(to_plane(flat[:, :1] * right + flat[:, 1:] * up, sight), flat, atol=1e-9)


@given(sight=SIGHTS, points=PLACES)
def test_straight_lines_stay_straight_and_near_things_near(sight, points):
    start, end = points[:10], points[10:]
    seen = [foreshorten(part, sight) for part in (start, (start + end) / 2, end)]
    aside = np.cross(seen[1] - seen[0], seen[2] - seen[0])
    assert np.linalg.norm(aside, axis=1).max() < 1e-6 * 12**2
    toward = view_axes(sight.yaw)[2]
    assert (np.argsort(points @ toward) == np.argsort(foreshorten(points, sight) @ toward)).all()


@given(sight=SIGHTS, points=PLACES)
def test_lines_of_sight_do_not_move_what_is_seen(sight, points):
    along = lines_of_sight(points, sight)
    assert np.allclose(along @ view_axes(sight.yaw)[2], 1.0)
    assert np.allclose(to_plane(points + 0.5 * along, sight), to_plane(points, sight), atol=1e-9)


def test_an_eye_sees_along_straight_rays():
    sight = Viewpoint(30.0, distance=20.0, eye=1.5)
    right, up, toward = view_axes(30.0)
    eye = 20.0 * toward + 1.5 * up
    point = np.array([2.0, 7.0, -3.0])
    ray = point - eye
    hit = eye + ray * (-(eye @ toward) / (ray @ toward))  # where the ray meets the plane through the axis
    assert to_plane(point[None], sight)[0] == pytest.approx([hit @ right, hit @ up])


def test_what_is_nearer_than_a_tenth_of_the_distance_grows_no_more():
    sight = Viewpoint(0.0, distance=10.0)
    assert growth([[0, 0, 9.5], [0, 0, 12.0]], sight).tolist() == [10.0, 10.0]
