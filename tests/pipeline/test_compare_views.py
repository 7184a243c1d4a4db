"""How alike two views are: laws, and the trees whose views are known."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from flowtree.errors import InputError
from flowtree.matting.extract_matte import extract_matte
from flowtree.model.camera import Camera
from flowtree.model.matte import Matte
from flowtree.photos.frame_view import frame_view
from flowtree.photos.load_photo import load_photo
from flowtree.pipeline.build_report import _ALIKE
from flowtree.pipeline.compare_views import check_same_tree, compare_views

_TRUTH = Path(__file__).parents[2] / ".." / "shared" / "data" / "truth"
_ALPHAS = arrays(np.float32, (64, 8), elements=st.floats(0.0, 1.0, width=32))
_CAMERA = Camera(0.0, 1 / 64, (4.0, 64.0), 8, 64)


def _matte(alpha):
    return Matte(alpha, np.zeros((*alpha.shape, 3), np.uint8), "alpha channel")


@settings(max_examples=25, deadline=None)
@given(a=_ALPHAS, b=_ALPHAS)
def test_is_symmetric_bounded_and_one_for_equals(a, b):
    alike = compare_views(_matte(a), _CAMERA, _matte(b), _CAMERA, height=1.0)
    assert 0.0 <= alike <= 1.0
    assert alike == pytest.approx(compare_views(_matte(b), _CAMERA, _matte(a), _CAMERA, height=1.0))
    assert compare_views(_matte(a), _CAMERA, _matte(a), _CAMERA, height=1.0) == pytest.approx(1.0)


@settings(max_examples=25, deadline=None)
@given(a=_ALPHAS, seed=st.integers(0, 99))
def test_does_not_depend_on_where_in_a_row_things_are(a, seed):
    mixed = np.random.default_rng(seed).permuted(a, axis=1)
    assert compare_views(_matte(a), _CAMERA, _matte(mixed), _CAMERA, height=1.0) == pytest.approx(1.0)


def test_a_crown_and_a_hedge_have_nothing_in_common():
    crown, hedge = np.zeros((64, 8), np.float32), np.zeros((64, 8), np.float32)
    crown[:32], hedge[32:] = 1.0, 1.0
    assert compare_views(_matte(crown), _CAMERA, _matte(hedge), _CAMERA, height=1.0) == 0.0


@pytest.mark.skipif(not _TRUTH.is_dir(), reason="the shared test data is not beside the project")
@pytest.mark.parametrize("name", ["aspen", "birch", "maple_bare", "willow"])
def test_views_of_one_tree_pass(name):
    views = []
    for yaw in (0, 90):
        matte = extract_matte(load_photo(_TRUTH / name / f"ortho_{yaw:03d}.png"))
        views += [matte, frame_view(matte, yaw=yaw, height=10.0)]
    assert compare_views(*views, height=10.0) > _ALIKE + 0.1


def test_views_that_do_not_match_at_all_are_refused_by_name():
    crown, hedge = np.zeros((64, 8), np.float32), np.zeros((64, 8), np.float32)
    crown[:32], hedge[32:] = 1.0, 1.0
    with pytest.raises(InputError, match=r"b\.png: must show the same tree as a\.png"):
        check_same_tree(["a.png", "b.png"], [_matte(crown), _matte(hedge)], [_CAMERA] * 2, height=1.0)
    check_same_tree(["a.png", "b.png"], [_matte(crown)] * 2, [_CAMERA] * 2, height=1.0)
