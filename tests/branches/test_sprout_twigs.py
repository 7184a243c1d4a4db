from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.branches.sprout_twigs import sprout_twigs
from flowtree.params import TwigParams
from tests.crowns import HEIGHT, branch_out, lone_branch
from tests.skeletons import random_skeleton

PARAMS = st.builds(
    TwigParams,
    length=st.floats(1e-3, 0.5),
    bare_length=st.floats(1e-3, 0.5),
    frequency=st.floats(0, 300),
    most=st.integers(0, 3000),
    divergence=st.floats(0, 360),
    angle=st.floats(0, 120),
    plagiotropism=st.floats(0, 1),
    rigidity=st.floats(0, 1),
    curl=st.floats(0, 1),
    side_twigs=st.integers(0, 8),
    radius=st.floats(1e-6, 0.01),
    bearing_particles=st.integers(1, 10_000),
)


def check_grown(made):
    count = len(made.parent)
    assert made.parent[0] == -1
    assert (made.parent[1:] >= 0).all()
    assert (made.parent < np.arange(count)).all()
    assert np.isfinite(made.points).all()
    assert len(made.points) == len(made.radius) == len(made.level) == len(made.twig) == count


@settings(max_examples=25, deadline=None)
@given(params=PARAMS, seed=st.integers(0, 10_000), leafy=st.booleans(), nodes=st.integers(2, 60))
def test_any_parameters_and_any_skeleton_give_a_tree(params, seed, leafy, nodes):
    before = random_skeleton(seed, nodes, step_in_thickness=0.1)
    made = sprout_twigs(before, leafy=leafy, params=params, seed=seed)
    check_grown(made)
    if params.most == 0 or params.frequency == 0:
        assert made is before


def test_what_was_there_stays_and_no_twig_is_thicker_than_its_branch():
    before = branch_out()
    made = sprout_twigs(before, height=HEIGHT)
    old, new = ~made.twig, made.twig
    assert np.array_equal(made.points[old], before.points)
    assert np.array_equal(made.radius[old], before.radius)
    assert new.any()
    assert (made.radius[1:] <= made.radius[made.parent[1:]] * (1 + 1e-6)).all()


def test_no_twig_grows_on_the_trunk_or_on_thick_limbs():
    made = sprout_twigs(branch_out(), height=HEIGHT)
    base = made.twig & ~made.twig[np.maximum(made.parent, 0)]
    bearer = made.parent[base]
    assert (made.radius[bearer] <= 0.3 * made.radius[0] + 1e-6).all()


def test_the_larger_the_crown_the_more_twigs():
    small, large = (sprout_twigs(lone_branch((1, 0.2, 0), length=long), height=HEIGHT) for long in (1.0, 4.0))
    assert 0 < small.twig.sum() < large.twig.sum()


def test_a_coarse_skeleton_gets_branchlets_that_bear_the_twigs():
    before = branch_out(branches=3)
    made = sprout_twigs(before, height=HEIGHT)
    base = made.twig & ~made.twig[np.maximum(made.parent, 0)]
    on_twigs = made.twig & made.twig[np.maximum(made.parent, 0)]
    children = np.bincount(made.parent[1:], minlength=len(made.parent))
    assert base.sum() > 5
    assert (children[on_twigs] > 1).any()


def test_twigs_of_a_bare_tree_are_longer_and_branch():
    leafy, bare = (sprout_twigs(branch_out(), height=HEIGHT, leafy=flag) for flag in (True, False))
    assert bare.twig.sum() > 2 * leafy.twig.sum()


def test_a_stem_of_one_thickness_gets_twigs_on_its_outer_half():
    stem = replace(
        lone_branch((0, 1, 0), length=4.0),
        radius=np.full(22, 0.05, np.float32),
        particles=np.ones(22, np.int32),
    )
    made = sprout_twigs(stem)
    base = made.twig & ~made.twig[np.maximum(made.parent, 0)]
    assert base.any()
    assert made.points[made.parent[base], 1].min() > 0.4 * made.points[:, 1].max()


@pytest.mark.parametrize("height", [0.05, 8.0, 150.0])
def test_the_tree_is_the_same_at_any_scale(height):
    """Same counts and same shape: every length is a share of the height."""
    base = branch_out()
    scaled = replace(
        base,
        points=(base.points * height / HEIGHT).astype(np.float32),
        radius=(base.radius * height / HEIGHT).astype(np.float32),
    )
    one, two = sprout_twigs(base, height=HEIGHT), sprout_twigs(scaled, height=height)
    assert two.twig.sum() == pytest.approx(one.twig.sum(), rel=0.02)


def test_a_seed_gives_its_bytes_and_another_gives_others():
    one, two, other = (sprout_twigs(branch_out(), height=HEIGHT, seed=s) for s in (1, 1, 2))
    assert one.points.tobytes() == two.points.tobytes()
    assert one.points.tobytes() != other.points.tobytes()
