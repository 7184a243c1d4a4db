import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.branches.draw_poses import draw_poses
from flowtree.model.volume import DensityVolume

FIRST = np.array([0, 3])
ARM = np.array([[0.1, 0, 0], [0.2, 0, 0], [0.3, 0, 0], [0, 0.2, 0], [0, 0.4, 0]])
PIVOT = np.array([[0.0, 1.0, 0.0], [0.5, 1.0, 0.0]])


def volume_of(density):
    return DensityVolume(density.astype(np.float32), np.array([-1.0, 0.0, -1.0], np.float32), 0.1)


def poses_in(volume, seed=0, count=8, spread=20.0):
    code = np.array([11, 7])
    return draw_poses(ARM, FIRST, PIVOT, code, count=count, spread=spread, volume=volume, seed=seed)


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10_000), count=st.integers(1, 12), spread=st.floats(0, 90))
def test_the_first_pose_is_as_it_was_and_all_are_small_changes(seed, count, spread):
    volume = volume_of(np.random.default_rng(seed).random((20, 20, 20)))
    poses = poses_in(volume, seed, count, spread)
    assert poses.turn.shape == (2, count, 3, 3)
    assert poses.slim.shape == (2, count)
    assert np.array_equal(poses.turn[:, 0], np.broadcast_to(np.eye(3), (2, 3, 3)))
    assert (poses.slim[:, 0] == 1).all()
    assert ((poses.slim > 0.69) & (poses.slim <= 1)).all()
    stretch = np.cbrt(np.linalg.det(poses.turn))
    assert ((stretch > 0.69) & (stretch < 1.26)).all()
    again = poses_in(volume, seed, count, spread)
    assert again.turn.tobytes() == poses.turn.tobytes()


def test_poses_lie_where_it_is_dense():
    below = np.zeros((20, 20, 20))
    below[:, :10] = 1.0  # under y = 1
    turn = poses_in(volume_of(below), spread=40.0).turn[0, 1:]
    assert (np.einsum("pij,j->pi", turn, ARM[2])[:, 1] < 0).all()


def test_an_empty_volume_prefers_nothing():
    assert np.isfinite(poses_in(volume_of(np.zeros((20, 20, 20)))).turn).all()
