import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.branches.smooth_branches import smooth_branches
from flowtree.geometry.parent_array import child_count
from tests.branches.traces import random_traces


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 10_000), rounds=st.integers(0, 12))
def test_root_and_tips_stay_and_nothing_leaves_the_hull(seed, rounds):
    traces = random_traces(seed, 80)
    points = traces.points.astype(float)
    smooth = smooth_branches(traces.parent, points, traces.particles, rounds=rounds)
    fixed = child_count(traces.parent) == 0
    fixed[0] = True
    assert np.array_equal(smooth[fixed], points[fixed])
    assert (smooth >= points.min(axis=0) - 1e-12).all()
    assert (smooth <= points.max(axis=0) + 1e-12).all()
    if rounds == 0:
        assert np.array_equal(smooth, points)


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 10_000))
def test_equals_one_node_after_the_other(seed):
    traces = random_traces(seed, 40)
    before = traces.points.astype(float)
    after = before.copy()
    for i in range(1, len(before)):
        children = np.flatnonzero(traces.parent == i)
        if len(children):
            ahead = max(children, key=lambda k: (traces.particles[k], -k))
            after[i] = before[i] / 2 + (before[traces.parent[i]] + before[ahead]) / 4
    assert np.allclose(smooth_branches(traces.parent, before, traces.particles, rounds=1), after)


def test_what_is_straight_and_even_stays():
    points = np.multiply.outer(np.arange(10.0), [0.2, 1.0, -0.3])
    parent = np.arange(-1, 9, dtype=np.int32)
    assert np.allclose(smooth_branches(parent, points, np.ones(10), rounds=50), points)


def test_a_side_branch_does_not_pull_at_its_limb():
    parent = np.array([-1, 0, 1, 2, 1], np.int32)
    points = np.array([[0, 0, 0], [0, 1, 0], [0, 2, 0], [0, 3, 0], [5, 1, 0]], float)
    smooth = smooth_branches(parent, points, np.array([4, 4, 3, 3, 1]), rounds=10)
    assert np.allclose(smooth, points)
