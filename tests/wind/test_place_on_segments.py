from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.errors import InputError
from flowtree.wind.place_on_segments import place_on_segments
from tests.skeletons import random_skeleton


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 1000), aside=st.floats(0, 1))
def test_points_beside_a_segment_count_as_on_it(seed, aside):
    skeleton, rng = random_skeleton(seed, 40), np.random.default_rng(seed)
    node = rng.integers(1, 40, 50).astype(np.int32)
    wanted = rng.random(50)
    start = skeleton.points[skeleton.parent[node]].astype(float)
    axis = skeleton.points[node] - start
    across = np.cross(axis, rng.normal(size=(50, 3)))
    share = place_on_segments(
        skeleton, node, (start + wanted[:, None] * axis + aside * across).astype(np.float32)
    )
    assert ((share >= 0) & (share <= 1)).all()
    np.testing.assert_allclose(share, wanted, atol=1e-3)


def test_beyond_the_ends_and_at_the_root():
    skeleton = random_skeleton(0, 3)
    far = np.array([[0, -9, 0], [0, -9, 0], [0, 99, 0]], np.float32)
    assert place_on_segments(skeleton, np.array([0, 1, 1], np.int32), far).tolist() == [0, 0, 1]


@pytest.mark.parametrize("node", [[3], [-1], [0, 1]])
def test_unknown_nodes_are_refused(node):
    with pytest.raises(InputError, match="carrying nodes"):
        place_on_segments(random_skeleton(0, 3), np.array(node, np.int32), np.zeros((1, 3), np.float32))
