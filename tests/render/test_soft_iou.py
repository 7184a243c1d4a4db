"""The measure of fidelity: its laws, and that it sees through size and scale."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from flowtree.errors import InputError
from flowtree.model.camera import Camera
from flowtree.render.soft_iou import soft_iou

_CAMERA = Camera(yaw=0.0, metres_per_pixel=0.1, foot=(16.0, 32.0), width=32, height=32)
_HEIGHT = 3.2
_ALPHAS = arrays(np.float32, (32, 32), elements=st.floats(0.0, 1.0, width=32))


def _iou(a, b, camera=_CAMERA, other=_CAMERA, cells=16):
    return soft_iou(a, camera, b, other, height=_HEIGHT, cells=cells)


@settings(max_examples=25, deadline=None)
@given(a=_ALPHAS, b=_ALPHAS)
def test_is_symmetric_bounded_and_one_for_equals(a, b):
    score = _iou(a, b)
    assert 0.0 <= score <= 1.0
    assert score == pytest.approx(_iou(b, a), abs=1e-9)
    assert _iou(a, a) == pytest.approx(1.0)


@settings(max_examples=25, deadline=None)
@given(a=_ALPHAS, b=_ALPHAS)
def test_equals_the_obvious_block_average(a, b):
    # Cells of exactly 2 x 2 pixels: the slow way is a reshape.
    def blocks(x):
        return x.astype(np.float64).reshape(16, 2, 16, 2).mean(axis=(1, 3))

    most = np.maximum(blocks(a), blocks(b)).sum()
    expected = np.minimum(blocks(a), blocks(b)).sum() / most if most else 1.0
    assert _iou(a, b) == pytest.approx(expected, abs=1e-6)


@settings(max_examples=15, deadline=None)
@given(a=_ALPHAS, b=_ALPHAS, factor=st.integers(2, 4))
def test_does_not_depend_on_the_pictures_resolution(a, b, factor):
    fine = replace(
        _CAMERA,
        metres_per_pixel=_CAMERA.metres_per_pixel / factor,
        foot=(16.0 * factor, 32.0 * factor),
        width=32 * factor,
        height=32 * factor,
    )
    enlarged = np.repeat(np.repeat(b, factor, axis=0), factor, axis=1)
    assert _iou(a, enlarged, other=fine, cells=7) == pytest.approx(_iou(a, b, cells=7), abs=1e-6)


@settings(max_examples=15, deadline=None)
@given(a=_ALPHAS, b=_ALPHAS, margin=st.integers(1, 9))
def test_does_not_depend_on_empty_margins(a, b, margin):
    wide = replace(
        _CAMERA, foot=(16.0 + margin, 32.0 + margin), width=32 + 2 * margin, height=32 + 2 * margin
    )
    assert _iou(a, np.pad(b, margin), other=wide) == pytest.approx(_iou(a, b), abs=1e-6)


def test_twice_the_density_scores_one_half():
    thin, thick = np.full((32, 32), 0.25, np.float32), np.full((32, 32), 0.5, np.float32)
    assert _iou(thin, thick) == pytest.approx(0.5)


def test_two_empty_pictures_are_equal():
    assert _iou(np.zeros((32, 32), np.float32), np.zeros((32, 32), np.float32)) == 1.0


@pytest.mark.parametrize("height", [0.0, -1.0, np.nan])
def test_refuses_a_height_that_is_none(height):
    with pytest.raises(InputError, match="height"):
        soft_iou(np.zeros((32, 32)), _CAMERA, np.zeros((32, 32)), _CAMERA, height=height)


@pytest.mark.parametrize("alpha", [np.zeros((8, 8)), np.full((32, 32), np.nan), np.full((32, 32), 2.0)])
def test_refuses_a_picture_that_is_no_alpha(alpha):
    with pytest.raises(InputError, match="alpha"):
        _iou(alpha, np.zeros((32, 32)))
