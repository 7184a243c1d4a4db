import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.geometry.local_units import local_units, turn_between

ANGLES = st.floats(-np.pi, np.pi)


def unit(vector):
    return vector / np.linalg.norm(vector, axis=1, keepdims=True)


@given(st.integers(0, 10_000), st.booleans())
@settings(max_examples=25, deadline=None)
def test_the_parent_points_up_and_the_child_forward(seed, along_y):
    rng = np.random.default_rng(seed)
    along, child = unit(rng.normal(size=(20, 3))), rng.normal(size=(20, 3))
    if along_y:
        along[:] = [0.0, rng.choice([-1.0, 1.0]), 0.0]
    turn = local_units(along, child)
    assert np.allclose(turn @ turn.transpose(0, 2, 1), np.eye(3), atol=1e-9)
    assert np.allclose(np.linalg.det(turn), 1.0)
    assert np.allclose(np.einsum("nij,nj->ni", turn, along), [0.0, 1.0, 0.0], atol=1e-9)
    local = np.einsum("nij,nj->ni", turn, child)
    assert np.allclose(local[:, 0], 0.0, atol=1e-9)
    assert (local[:, 2] > 0.0).all()


def test_rodrigues_turns_the_short_way():
    start = unit(np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 2.0, 3.0]]))
    for end in (start, -start, np.roll(start, 1, axis=1)):
        turn = turn_between(start, end)
        assert np.allclose(np.einsum("nij,nj->ni", turn, start), end, atol=1e-7)
        angle = np.arccos(np.clip((np.trace(turn, axis1=1, axis2=2) - 1.0) / 2.0, -1.0, 1.0))
        assert np.allclose(angle, np.arccos(np.clip(np.sum(start * end, axis=1), -1.0, 1.0)), atol=1e-6)
