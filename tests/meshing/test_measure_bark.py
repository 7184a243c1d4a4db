"""The bark's colour comes from the trunk and from nothing beside it."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.meshing.measure_bark import measure_bark
from flowtree.model.camera import Camera
from flowtree.model.matte import Matte
from flowtree.model.skeleton import Skeleton

_CAMERA = Camera(0.0, 0.05, (50.0, 100.0), 100, 110)


def _pole(radius=0.3):
    """A trunk of 5 m up the y axis."""
    count = 6
    return Skeleton(
        parent=np.arange(-1, count - 1).astype(np.int32),
        points=np.stack([np.zeros(count), np.arange(count), np.zeros(count)], axis=1).astype(np.float32),
        radius=np.full(count, radius, np.float32),
        particles=np.ones(count, np.int32),
        level=np.zeros(count, np.int32),
        twig=np.zeros(count, bool),
    )


def _matte(trunk, beside=(0, 200, 0), alpha=1.0):
    color = np.empty((110, 100, 3), np.uint8)
    color[:] = beside
    color[:, 44:56] = trunk
    return Matte(np.full((110, 100), alpha, np.float32), color, "alpha channel")


@settings(max_examples=25, deadline=None)
@given(color=st.tuples(*[st.integers(0, 255)] * 3))
def test_is_the_trunks_colour(color):
    assert np.allclose(measure_bark(_pole(), [_matte(color)], [_CAMERA]), color)


def test_grass_before_the_trunk_does_not_count():
    matte = _matte((120, 90, 60))
    matte.foreground[85:] = (40, 160, 30)
    assert np.allclose(measure_bark(_pole(), [matte], [_CAMERA]), (120, 90, 60))


def test_views_count_together():
    mattes = [_matte((100, 90, 80)), _matte((100, 90, 80)), _matte((200, 190, 180))]
    assert np.allclose(measure_bark(_pole(), mattes, [_CAMERA] * 3), (100, 90, 80))


@pytest.mark.parametrize("matte", [_matte((1, 2, 3), alpha=0.2), _matte((1, 2, 3), alpha=0.0)])
def test_without_a_trunk_to_be_seen_it_is_a_grey_brown(matte):
    red, green, blue = measure_bark(_pole(), [matte], [_CAMERA])
    assert red > green > blue > 60
