import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.branches.shape_twigs import shape_twigs


@settings(max_examples=25, deadline=None)
@given(
    seed=st.integers(0, 10_000),
    count=st.integers(1, 5),
    side_twigs=st.integers(0, 12),
    angle=st.floats(0, 120),
    curl=st.floats(0, 1),
)
def test_shapes_are_trees_of_unit_shoots(seed, count, side_twigs, angle, curl):
    random = np.random.default_rng(seed)
    made = shape_twigs(count, side_twigs=side_twigs, angle=angle, curl=curl, random=random)
    nodes = 3 + side_twigs
    assert made.points.shape == (count, nodes, 3)
    assert made.parent[0] == -1
    assert (made.parent < np.arange(nodes)).all()
    assert (made.parent[1:] >= 0).all()
    assert np.isfinite(made.points).all()
    assert np.allclose(made.points[:, 2, 1], 1.0)  # along its axis every shoot is as long
    assert (made.thickness[1:] <= made.thickness[made.parent[1:]]).all()
    assert made.thickness[0] == 1


def test_side_twigs_stand_left_and_right_at_the_angle():
    made = shape_twigs(200, side_twigs=4, angle=48, curl=0, random=np.random.default_rng(0))
    out = made.points[:, 3:] - made.points[:, made.parent[3:]]
    assert (np.sign(out[..., 0]) == [1, -1, 1, -1]).all()
    turn = np.degrees(np.arctan2(np.abs(out[..., 0]), out[..., 1]))
    assert turn.min() >= 0.75 * 48 - 1e-6
    assert turn.max() <= 1.2 * 48 + 1e-6
    assert np.abs(np.median(turn) - 48) < 2
    assert np.unique(made.parent[3:]).tolist() == [0, 1]  # none at the very tip


def test_without_curl_shoots_are_straight_and_more_bends_them_more():
    tips = [
        shape_twigs(400, side_twigs=0, angle=0, curl=c, random=np.random.default_rng(0)).points[:, 2, [0, 2]]
        for c in (0.0, 0.1, 0.4)
    ]
    assert (tips[0] == 0).all()
    assert abs(np.std(tips[1]) - 0.1) < 0.01
    assert abs(np.std(tips[2]) - 0.4) < 0.04
