import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.branches.bound_radii import bound_radii
from flowtree.branches.da_vinci_radii import da_vinci_radii
from flowtree.model.attractor import LimbTree
from tests.skeletons import random_skeleton, skeleton_of


def forked():
    """A stem of 4 m and a limb from it, up to 9 m; and how thick they are."""
    stem = [[0, 0.1 * k, 0] for k in range(41)]
    limb = [[0.05 * k, 4 + 0.1 * k, 0.04 * k] for k in range(1, 51)]
    radius = np.concatenate([np.full(41, 0.3), np.linspace(0.15, 0.05, 50)])
    return skeleton_of(np.arange(-1, 90), np.array(stem + limb), np.random.default_rng(0)), radius


def limbs_of(skeleton, radius):
    return LimbTree(skeleton.parent, skeleton.points, radius.astype(np.float32))


def test_limbs_are_as_thick_as_measured():
    skeleton, radius = forked()
    noisy = radius * np.random.default_rng(1).uniform(0.97, 1.1, len(radius))
    noisy[20:30] = np.nan  # hidden
    bounds = bound_radii(skeleton, limbs_of(skeleton, noisy))
    clear = np.r_[5:20, 30:36, 48:80]  # not beside the fork, nor at the tip
    assert bounds[clear, 0] == pytest.approx(radius[clear], rel=0.1)
    assert np.array_equal(bounds[clear[:-20], 0], bounds[clear[:-20], 1])
    made = da_vinci_radii(skeleton, trunk_radius=0.3, bounds=bounds).radius
    assert made[5:36] == pytest.approx(radius[5:36], rel=0.1), "and between them as beside"


def test_a_limb_is_slender_whatever_is_measured():
    skeleton, radius = forked()
    bounds = bound_radii(skeleton, limbs_of(skeleton, np.full(len(radius), 0.3)))
    assert bounds[90, 0] == 0
    assert bounds[80, 0] < 0.1
    assert bounds[30, 0] == pytest.approx(0.3)


def test_of_a_thin_branch_it_is_only_the_most():
    skeleton, radius = forked()
    bounds = bound_radii(skeleton, limbs_of(skeleton, 0.05 * radius))
    assert (bounds[:, 0] == 0).all()
    assert (bounds[5:, 1] <= 0.02).all()


def test_what_no_picture_shows_has_no_bounds():
    skeleton, radius = forked()
    elsewhere = LimbTree(skeleton.parent, skeleton.points + 1, radius.astype(np.float32))
    for limbs in (limbs_of(skeleton, np.full(len(radius), np.nan)), elsewhere):
        bounds = bound_radii(skeleton, limbs)
        assert (bounds[:, 0] == 0).all()
        assert np.isinf(bounds[:, 1]).all()


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 10_000))
def test_bounds_hold_and_no_branch_grows_toward_its_tip(seed):
    rng = np.random.default_rng(seed)
    skeleton = random_skeleton(seed)
    least = np.where(rng.random(len(skeleton.parent)) < 0.5, rng.uniform(0, 0.2, len(skeleton.parent)), 0.0)
    bounds = np.stack([least, least + rng.exponential(0.1, len(least))], axis=1)
    bounds[0] = 0, np.inf
    made = da_vinci_radii(skeleton, trunk_radius=0.3, bounds=bounds).radius
    below = skeleton.parent[1:]
    assert (made[1:] <= made[below] * 1.0001).all()
    height = float(np.ptp(skeleton.points[:, 1]))
    assert (made[1:] <= np.maximum(bounds[1:, 1], 0.0002 * height) * 1.0001).all()
    assert (made[1:] >= np.minimum(bounds[1:, 0], made[below]) * 0.9999).all()


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 10_000), share=st.floats(0, 1))
def test_bounds_of_any_limbs_fall_toward_the_tips(seed, share):
    rng = np.random.default_rng(seed)
    skeleton = random_skeleton(seed)
    radius = np.where(
        rng.random(len(skeleton.parent)) < share, rng.uniform(0, 1, len(skeleton.parent)), np.nan
    )
    bounds = bound_radii(skeleton, limbs_of(skeleton, radius))
    assert (bounds[:, 0] <= bounds[:, 1]).all()
    known = np.isfinite(bounds[1:, 1]) & np.isfinite(bounds[skeleton.parent[1:], 1])
    assert (bounds[1:, 1][known] <= bounds[skeleton.parent[1:], 1][known]).all()


def test_a_side_branch_begins_as_thick_as_it_goes_on_whatever_the_stem_hides():
    stem = [[0, 0.2 * k, 0] for k in range(41)]
    limb = [[0.1 * k, 4 + 0.05 * k, 0] for k in range(1, 41)]
    parent = np.concatenate([np.arange(-1, 40), [20], np.arange(41, 80)])
    skeleton = skeleton_of(parent, np.array(stem + limb), np.random.default_rng(0))
    radius = np.where(np.arange(81) < 41, 0.3, np.where(np.arange(81) < 45, 0.3, 0.1))
    bounds = bound_radii(skeleton, limbs_of(skeleton, radius))
    assert bounds[41:60, 1] == pytest.approx(0.1)
    assert bounds[10:30, 1] == pytest.approx(0.3)
