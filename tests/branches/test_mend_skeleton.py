"""What is wrong with a skeleton from elsewhere is repaired and said, or refused in one line."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.branches.mend_skeleton import mend_skeleton
from flowtree.branches.order_branches import order_branches
from flowtree.errors import InputError
from flowtree.model.skeleton import Skeleton
from tests.trees import hand_made_skeleton


def skeleton(parent, points, radius) -> Skeleton:
    count = len(parent)
    return Skeleton(
        parent=np.array(parent, np.int32),
        points=np.array(points, np.float32),
        radius=np.array(radius, np.float32),
        particles=np.ones(count, np.int32),
        level=np.zeros(count, np.int32),
        twig=np.zeros(count, np.bool_),
    )


def test_a_sound_skeleton_stays_as_it_is():
    whole = hand_made_skeleton()
    mended, notes = mend_skeleton(whole)
    assert notes == ()
    for name in ("parent", "points", "radius", "particles", "twig"):
        np.testing.assert_array_equal(getattr(mended, name), getattr(whole, name))


def test_nodes_in_one_place_become_one():
    drawn = skeleton(
        [-1, 0, 1, 2, 1], [[0, 0, 0], [0, 1, 0], [0, 1, 0], [0, 2, 0], [1, 1, 0]], [3, 2, 1, 1, 1]
    )
    mended, notes = mend_skeleton(drawn)
    assert mended.parent.tolist() == [-1, 0, 1, 1]
    assert mended.radius.tolist() == [3, 2, 1, 1]
    assert notes == ("1 node dropped that lay in their parent's place",)


def test_radii_that_grow_are_evened_out():
    drawn = skeleton([-1, 0, 1], [[0, 0, 0], [0, 1, 0], [0, 2, 0]], [0.2, 0.1, 0.3])
    mended, notes = mend_skeleton(drawn)
    np.testing.assert_allclose(mended.radius, [0.25, 0.2, 0.2])
    assert notes == ("3 radii evened out that grew toward the tips",)


def test_missing_radii_follow_da_vinci():
    bare = dataclasses.replace(hand_made_skeleton(), radius=np.zeros(14, np.float32))
    mended, notes = mend_skeleton(bare)
    assert "Da Vinci" in notes[0]
    assert (mended.radius > 0).all()
    some = hand_made_skeleton()
    some.radius[[2, 5]] = 0
    mended, notes = mend_skeleton(some)
    assert notes == ("2 radii missing: they follow Da Vinci's rule between the others",)
    kept = np.setdiff1d(np.arange(14), [2, 5])
    np.testing.assert_array_equal(mended.radius[kept], some.radius[kept])
    assert some.radius[3] <= mended.radius[2] <= some.radius[1]


def test_height_scales_everything_and_z_is_turned_up():
    whole = hand_made_skeleton()
    mended, _ = mend_skeleton(whole, height=7.0)
    np.testing.assert_allclose(mended.points, whole.points * 2, rtol=1e-6)
    np.testing.assert_allclose(mended.radius, whole.radius * 2, rtol=1e-6)
    lying = dataclasses.replace(whole, points=whole.points[:, [0, 2, 1]] * np.float32([1, -1, 1]))
    np.testing.assert_array_equal(mend_skeleton(lying, up="z")[0].points, whole.points)
    drawn = skeleton([-1, 0], [[0, 0, 0], [0, 0.3, 5]], [0.1, 0.1])
    assert "if z points up there, say so" in mend_skeleton(drawn)[1][0]


@pytest.mark.parametrize(
    ("drawn", "message"),
    [
        (skeleton([-1], [[0, 0, 0]], [1]), "needs a segment, but got a single node"),
        (skeleton([-1, 0], [[0, 0, 0]] * 2, [1, 1]), "needs a segment, but got all nodes in one place"),
        (skeleton([-1, 0], [[0, 0, 0], [0, -1, 0]], [1, 1]), "must rise above its root"),
        (skeleton([-1, 0], [[0, 0, 0], [0, 9000, 0]], [1, 1]), "must be 0.01 to 200 m high"),
    ],
)
def test_what_cannot_be_a_tree_is_refused(drawn, message):
    with pytest.raises(InputError, match=message):
        mend_skeleton(drawn)


@settings(max_examples=25, deadline=None)
@given(data=st.data())
def test_whatever_comes_out_tapers(data):
    count = data.draw(st.integers(2, 25))
    parent = [-1] + [data.draw(st.integers(0, k - 1)) for k in range(1, count)]
    number = st.floats(-3, 3, width=32)
    points = [[0, 0, 0]] + [[data.draw(number) for _ in range(3)] for _ in range(1, count)]
    radius = [data.draw(st.sampled_from([0.0, 0.01, 0.1, 0.5])) for _ in range(count)]
    try:
        mended, _ = mend_skeleton(skeleton(parent, points, radius), height=5.0)
    except InputError:
        return
    up = mended.parent[1:]
    assert (up < np.arange(1, len(mended.parent))).all()
    assert (np.linalg.norm(mended.points[1:] - mended.points[up], axis=1) > 0).all()
    assert (mended.radius > 0).all()
    assert (mended.radius[1:] <= mended.radius[up] * (1 + 1e-6)).all()
    np.testing.assert_allclose(mended.points[:, 1].max(), 5.0, rtol=1e-5)
    np.testing.assert_array_equal(mended.level, order_branches(mended.parent, mended.radius))
