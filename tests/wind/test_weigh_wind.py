from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.errors import InputError
from flowtree.model.skeleton import Skeleton
from flowtree.wind.weigh_wind import weigh_wind
from tests.skeletons import random_skeleton
from tests.trees import hand_made_skeleton


def thin_out(skeleton: Skeleton, keep: np.ndarray) -> Skeleton:
    """The skeleton without inner nodes of unbranched runs."""
    number = np.cumsum(keep) - 1
    above = skeleton.parent.copy()
    for node in np.flatnonzero(keep)[1:]:
        while not keep[above[node]]:
            above[node] = skeleton.parent[above[node]]
    parent = np.where(above >= 0, number[above], -1)[keep].astype(np.int32)
    rest = {
        field.name: getattr(skeleton, field.name)[keep]
        for field in dataclasses.fields(skeleton)
        if field.name != "parent"
    }
    return Skeleton(parent=parent, **rest)


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10_000), nodes=st.integers(1, 120), thickness=st.floats(0, 1))
def test_the_foot_stays_and_extents_grow_toward_the_tips(seed, nodes, thickness):
    skeleton = random_skeleton(seed, nodes, step_in_thickness=thickness)
    weights = weigh_wind(skeleton, height=10.0, seed=seed)
    assert (weights.extent[0] == 0).all()
    assert (weights.pivot[0] == skeleton.points[0]).all()
    above = skeleton.parent[1:]
    assert (weights.extent[1:] >= weights.extent[above]).all()
    assert (weights.extent <= 1).all()
    assert (weights.depth[1:] >= weights.depth[above]).all()
    assert set(weights.depth.tolist()) <= {0, 1, 2}
    assert ((weights.phase >= 0) & (weights.phase < 1)).all()
    for name in ("depth", "pivot", "extent", "phase"):
        assert np.isfinite(getattr(weights, name)).all()
        assert len(getattr(weights, name)) == nodes


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10_000))
def test_a_branch_begins_still_at_its_pivot(seed):
    skeleton = random_skeleton(seed, 80)
    weights = weigh_wind(skeleton, height=10.0)
    for tier in (1, 2):
        first = np.flatnonzero(
            (weights.depth >= tier) & (weights.depth[np.maximum(skeleton.parent, 0)] < tier)
        )
        above = skeleton.parent[first]
        assert (weights.extent[above, tier] == 0).all()
        np.testing.assert_array_equal(weights.pivot[first, tier - 1], skeleton.points[above])
        # What hangs on a limb has the limb's extent where it hangs, to its very tips.
        assert (weights.extent[first, :tier] == weights.extent[above, :tier]).all()


def test_tiers_of_a_tree_made_by_hand():
    skeleton = hand_made_skeleton(4)
    weights = weigh_wind(skeleton, height=3.5)
    assert weights.depth.tolist() == [0] * 4 + [1] * 8
    assert (weights.extent[4:, 2] == 0).all()
    assert (weights.extent[:4, 1:] == 0).all()
    np.testing.assert_array_equal(weights.pivot[:4], 0)
    np.testing.assert_array_equal(weights.pivot[4, 0], skeleton.points[skeleton.parent[4]])
    assert len(set(weights.phase[4:, 0].tolist())) == 4, "one phase a limb"


def test_thin_branches_bend_more_than_thick_ones():
    skeleton = hand_made_skeleton(3)
    thin = dataclasses.replace(
        skeleton, radius=np.where(skeleton.level > 0, skeleton.radius / 2, skeleton.radius)
    )
    stiff, limp = (weigh_wind(each, height=3.5).extent for each in (skeleton, thin))
    assert (limp[4:, 1] > stiff[4:, 1]).all()


def test_size_and_seed():
    skeleton = random_skeleton(3, 100)
    weights = weigh_wind(skeleton, height=10.0, seed=1)
    larger = dataclasses.replace(skeleton, points=skeleton.points * 2, radius=skeleton.radius * 2)
    np.testing.assert_allclose(weigh_wind(larger, height=20.0, seed=1).extent, weights.extent, rtol=1e-5)
    again, other = weigh_wind(skeleton, height=10.0, seed=1), weigh_wind(skeleton, height=10.0, seed=2)
    for name in ("depth", "pivot", "extent", "phase"):
        assert getattr(again, name).tobytes() == getattr(weights, name).tobytes()
    assert (other.phase != weights.phase).any()
    assert other.extent.tobytes() == weights.extent.tobytes()


@pytest.mark.parametrize("seed", range(5))
def test_a_thinned_skeleton_swings_alike(seed):
    skeleton = random_skeleton(seed, 300, stubborn=0.95)
    children = np.bincount(skeleton.parent[1:], minlength=300)
    inner = (children == 1) & (skeleton.level[np.maximum(skeleton.parent, 0)] == skeleton.level)
    keep = ~inner | (np.arange(300) % 2 == 0)
    keep[0] = True
    coarse = weigh_wind(thin_out(skeleton, keep), height=10.0)
    fine = weigh_wind(skeleton, height=10.0)
    assert keep.sum() < 200
    np.testing.assert_array_equal(coarse.depth, fine.depth[keep])
    np.testing.assert_array_equal(coarse.pivot, fine.pivot[keep])
    assert np.abs(coarse.extent - fine.extent[keep]).max() < 0.15
    assert np.abs(coarse.extent - fine.extent[keep]).mean() < 0.02
    turned = np.abs(coarse.phase - fine.phase[keep])
    assert np.median(np.minimum(turned, 1 - turned)) < 0.02


def test_wood_without_thickness_and_one_node_are_weighed_too():
    skeleton = random_skeleton(0, 20)
    bare = dataclasses.replace(skeleton, radius=np.zeros(20, np.float32))
    assert np.isfinite(weigh_wind(bare, height=1.0).extent).all()
    assert weigh_wind(random_skeleton(0, 1), height=1.0).extent.tolist() == [[0, 0, 0]]


@pytest.mark.parametrize("height", [0.0, -1.0, np.nan, np.inf])
def test_a_height_must_be_positive(height):
    with pytest.raises(InputError, match="height"):
        weigh_wind(random_skeleton(0, 5), height=height)
