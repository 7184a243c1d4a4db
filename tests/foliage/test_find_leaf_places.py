"""The rule by which leaves stand on a twig."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.foliage.find_leaf_places import bearing_way, find_leaf_places
from flowtree.params import LeafParams
from tests.crowns import lone_branch

TWIG = lone_branch((1, 0, 0), nodes=4)


def places(rate=50.0, length=0.1, seed=0, **params):
    return find_leaf_places(
        TWIG, rate=rate, length=length, height=8.0, params=LeafParams(**params), seed=seed
    )


@settings(max_examples=20, deadline=None)
@given(
    rate=st.floats(0.1, 200),
    hang=st.floats(0, 3),
    plagiotropism=st.floats(0, 1),
    angle=st.floats(0, 120),
    seed=st.integers(0, 1000),
)
def test_axes_are_a_frame_and_leaves_stand_on_their_segment(rate, hang, plagiotropism, angle, seed):
    made = places(rate, seed=seed, hang=hang, plagiotropism=plagiotropism, angle=angle)
    assert np.allclose(np.linalg.norm(made.along, axis=1), 1.0)
    assert np.allclose(np.linalg.norm(made.normal, axis=1), 1.0)
    assert np.allclose((made.along * made.normal).sum(axis=1), 0.0, atol=1e-9)
    assert np.allclose(made.position[:, 1:], TWIG.points[made.node][:, 1:], atol=1e-5)
    start, end = TWIG.points[TWIG.parent[made.node], 0], TWIG.points[made.node, 0]
    assert ((made.position[:, 0] >= start - 1e-5) & (made.position[:, 0] <= end + 1e-5)).all()


def test_as_many_as_the_rate_says_and_only_where_it_is_thin():
    made = places(rate=50.0)
    assert bearing_way(TWIG, LeafParams()).sum() == pytest.approx(4.0, rel=1e-3)
    assert len(made.node) == pytest.approx(50.0 * 4.0, abs=5)
    assert made.node.min() > 1
    assert made.length.mean() == pytest.approx(0.1, rel=0.05)


def test_hanging_leaves_point_down_and_level_ones_look_up():
    up, down = (places(hang=hang, plagiotropism=1.0).along[:, 1].mean() for hang in (0.0, 3.0))
    assert down < -0.8 < up
    loose, strict = (places(hang=0.2, plagiotropism=p).normal[:, 1].mean() for p in (0.0, 1.0))
    assert strict > 0.5
    assert strict > loose + 0.1


def test_opposite_leaves_come_in_pairs_that_face_each_other():
    made = places(rate=40.0, whorl=2, hang=0.0, plagiotropism=0.5)
    first, second = made.position[::2], made.position[1::2]
    assert np.allclose(first, second)
    across = made.along[:, 1:] / np.linalg.norm(made.along[:, 1:], axis=1, keepdims=True)
    assert np.median((across[::2] * across[1::2]).sum(axis=1)) < -0.7
    assert len(made.node) == pytest.approx(40.0 * 4.0, abs=10)
