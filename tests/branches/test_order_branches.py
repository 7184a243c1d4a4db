import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.branches.order_branches import order_branches


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10_000), count=st.integers(1, 60))
def test_equals_counting_the_forks_on_the_way_down(seed, count):
    rng = np.random.default_rng(seed)
    parent = np.array([-1, *(rng.integers(max(0, k - 5), k) for k in range(1, count))], np.int32)
    weight = rng.integers(0, 4, count)
    order = order_branches(parent, weight)
    for node in range(count):
        forks, at = 0, node
        while parent[at] >= 0:
            siblings = np.flatnonzero(parent == parent[at]).tolist()
            forks += max(siblings, key=lambda k: (weight[k], -k)) != at
            at = parent[at]
        assert order[node] == forks


def test_one_shoot_is_all_trunk():
    assert order_branches(np.arange(-1, 9, dtype=np.int32), np.ones(10)).tolist() == [0] * 10
