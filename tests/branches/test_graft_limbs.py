import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.branches.graft_limbs import graft_limbs
from flowtree.geometry.parent_array import child_count, sum_to_root
from flowtree.model.attractor import LimbTree
from tests.branches.traces import own_of, random_traces


def random_limbs(seed, count):
    made = random_traces(seed, count)
    return LimbTree(made.parent, made.points, np.full(count, np.nan, np.float32))


def stem(nodes=21):
    points = np.zeros((nodes, 3), np.float32)
    points[:, 1] = np.linspace(0, 1, nodes)
    return LimbTree(np.arange(-1, nodes - 1, dtype=np.int32), points, np.full(nodes, np.nan, np.float32))


@settings(max_examples=25, deadline=None)
@given(
    seed=st.integers(0, 10_000),
    count=st.integers(2, 80),
    reach=st.floats(0, 1),
    angle=st.floats(5, 90),
    collapsed=st.booleans(),
)
def test_all_particles_stay_in_one_tree_with_every_limb(seed, count, reach, angle, collapsed):
    traces = random_traces(seed, collapsed=collapsed)
    limbs, own = random_limbs(seed + 1, count), own_of(traces.parent, traces.particles)
    parent, points, left, limb = graft_limbs(
        traces.parent, traces.points.astype(float), own, limbs, reach=reach, angle=angle
    )
    assert parent[0] == -1
    assert (parent[1:] >= 0).all()
    assert (parent < np.arange(len(parent))).all()
    assert left.sum() == own.sum()
    assert (left >= 0).all()
    assert (sum_to_root(parent, left) > 0).all()
    assert limb[0]
    assert limb[parent[limb & (parent >= 0)]].all(), "a limb grows from a limb"
    assert (left[child_count(parent) == 0] > 0).all()
    if own.sum() >= 2 * count:  # enough for every tip
        assert limb.sum() == count
        assert np.array_equal(np.sort(points[limb], axis=0), np.sort(limbs.points.astype(float), axis=0)), (
            "limbs stay where the pictures show them"
        )


def test_a_path_ends_at_the_limb_it_comes_to():
    """It comes from the right, reaches the stem at half its height, and runs down beside it."""
    way = [[0.01, 0.1 * k, 0] for k in range(1, 5)] + [[0.1 * k, 0.5, 0] for k in range(1, 5)]
    points = np.array([[0, 0, 0], *way], float)
    own = np.zeros(9, np.int32)
    own[8] = 7
    parent, places, left, limb = graft_limbs(
        np.arange(-1, 8, dtype=np.int32), points, own, stem(), reach=0.05, angle=45
    )
    free = np.flatnonzero(~limb)
    assert len(free) == 4
    entry = places[parent[free[0]]]
    assert entry == pytest.approx([0, 0.4, 0])
    assert left.sum() == 7


def test_a_limb_to_which_nobody_comes_is_there():
    own = np.array([5, 0, 0], np.int32)
    points = np.array([[0, 0, 0], [0, 0.02, 0], [0, 0.04, 0]])
    own[2] = 4
    parent, places, left, limb = graft_limbs(
        np.array([-1, 0, 1], np.int32), points, own, stem(), reach=0.05, angle=45
    )
    assert limb.all()
    assert places[:, 1].max() == 1
    assert left[child_count(parent) == 0].tolist() == [1]
    assert left.sum() == 9
