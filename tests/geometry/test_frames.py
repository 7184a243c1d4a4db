import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from flowtree.geometry.frames import quaternions, side_axes, unit

AXES = [[0, 1, 0], [0, -1, 0], [1, 0, 0], [0, 0, -1], [1e-7, 1, 0], [1e-3, -1, 0]]


def directions(seed, count=20):
    return unit(np.concatenate([np.random.default_rng(seed).normal(size=(count, 3)), AXES]))


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10_000), scale=st.floats(1e-6, 1e6))
def test_units_have_length_one_and_keep_their_direction(seed, scale):
    vectors = np.random.default_rng(seed).normal(size=(9, 3)) * scale
    made = unit(vectors)
    assert np.allclose(np.linalg.norm(made, axis=1), 1)
    assert np.allclose(np.cross(made, vectors / scale), 0)
    assert unit(np.zeros((2, 3))).tolist() == [[0, 0, 0]] * 2


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10_000))
def test_side_axes_are_a_right_handed_frame_whose_first_is_nearest_to_up(seed):
    axis = directions(seed)
    first, second = side_axes(axis)
    for a, b in ((first, first), (second, second), (axis, axis)):
        assert np.allclose(np.sum(a * b, axis=1), 1)
    for a, b in ((axis, first), (axis, second), (first, second)):
        assert np.allclose(np.sum(a * b, axis=1), 0, atol=1e-9)
    assert np.allclose(np.cross(axis, first), second)
    turned = np.cos(0.3) * first + np.sin(0.3) * second
    level = np.abs(axis[:, 1]) < 1 - 1e-6
    assert (first[level, 1] >= turned[level, 1] - 1e-12).all()
    assert (first[level, 1] >= -1e-12).all()


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10_000))
def test_quaternions_reproduce_the_frames(seed):
    y = directions(seed)
    z, _ = side_axes(y)
    made = quaternions(np.cross(y, z), y, z)
    assert np.allclose(np.linalg.norm(made, axis=1), 1)
    turns = Rotation.from_quat(made)
    for start, end in ((np.eye(3)[0], np.cross(y, z)), (np.eye(3)[1], y), (np.eye(3)[2], z)):
        assert np.allclose(turns.apply(np.tile(start, (len(y), 1))), end, atol=1e-9)


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10_000))
def test_quaternions_of_any_rotation_are_the_librarys(seed):
    """Half turns too, whose scalar part is 0."""
    wanted = Rotation.random(20, random_state=seed).as_quat()
    half = np.zeros((3, 4))
    half[:, :3] = np.eye(3)
    wanted = np.concatenate([wanted, half, [[0, 0, 0, 1]]])
    x, y, z = (Rotation.from_quat(wanted).as_matrix()[:, :, k] for k in range(3))
    made = quaternions(x, y, z)
    assert np.allclose(np.abs(np.sum(made * wanted, axis=1)), 1)
