import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.errors import InputError
from flowtree.model.matte import Matte
from flowtree.photos.frame_view import frame_view


def matte(alpha):
    alpha = np.asarray(alpha, np.float32)
    return Matte(alpha, np.zeros((*alpha.shape, 3), np.uint8), "automatic")


def lollipop(height=200, width=120, top=20, foot=180, x=66, half=3):
    alpha = np.zeros((height, width), np.float32)
    rows, columns = np.mgrid[:height, :width] + 0.5
    radius = (foot - top) / 3
    alpha[np.hypot(rows - top - radius, columns - x) < radius] = 1.0
    alpha[top + int(radius) : foot, x - half : x + half] = 1.0
    return alpha


def test_foot_top_and_scale_of_a_known_tree():
    camera = frame_view(matte(lollipop()), yaw=90, height=8.0)
    assert camera.foot == pytest.approx((66.0, 180.0))
    assert camera.metres_per_pixel == pytest.approx(8.0 / 160, rel=0.01)
    assert (camera.width, camera.height, camera.yaw) == (120, 200, 90.0)


def test_specks_and_faint_haze_move_nothing():
    clean = frame_view(matte(lollipop()), yaw=0, height=8.0)
    dirty = lollipop()
    dirty[2:4, 5:7] = dirty[196:199, 100:103] = dirty[190, 66] = 1.0
    dirty = np.maximum(dirty, 0.1)
    assert frame_view(matte(dirty), yaw=0, height=8.0) == clean


def test_mirrored_matte_mirrors_the_foot():
    alpha = lollipop()
    alpha[60:64, 66:110] = 1.0
    there = frame_view(matte(alpha), yaw=0, height=5.0)
    back = frame_view(matte(alpha[:, ::-1]), yaw=0, height=5.0)
    assert back.foot[0] == pytest.approx(120 - there.foot[0])
    assert back.foot[1] == there.foot[1]
    assert back.metres_per_pixel == there.metres_per_pixel


def test_given_foot_and_top_are_taken():
    camera = frame_view(matte(np.zeros((200, 120))), yaw=0, height=10.0, foot=(50.0, 150.0), top=50.0)
    assert camera.foot == (50.0, 150.0)
    assert camera.metres_per_pixel == pytest.approx(0.1)
    assert frame_view(matte(lollipop()), yaw=0, height=10.0, foot=(50.0, 120.0)).foot == (50.0, 120.0)


@pytest.mark.parametrize(
    ("alpha", "options", "says"),
    [
        (np.zeros((50, 50)), {}, "empty alpha"),
        (lollipop(), {"foot": (66.0, 10.0)}, "below the top"),
        (lollipop(), {"top": 190.0}, "below the top"),
        (lollipop(), {"foot": (500.0, 10.0)}, "in the picture"),
        (lollipop(), {"foot": (float("nan"), 10.0)}, "in the picture"),
        (lollipop(), {"top": -201.0}, "row of the picture"),
        (lollipop(), {"foot": (66.0, 401.0)}, "in the picture"),
        (lollipop(), {"height": 0.0}, "positive"),
        (lollipop(), {"height": float("inf")}, "positive"),
        (lollipop(), {"yaw": float("nan")}, "degrees"),
        (lollipop(50, 50, 20, 32, 25), {}, "16 pixels high"),
    ],
)
def test_what_cannot_be_framed_is_refused(alpha, options, says):
    with pytest.raises(InputError, match=says):
        frame_view(matte(alpha), **({"yaw": 0.0, "height": 5.0} | options))


@settings(max_examples=25, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1), fill=st.floats(0, 1), height=st.integers(1, 60), width=st.integers(1, 60)
)
def test_random_alpha_gives_a_camera_inside_or_an_input_error(seed, fill, height, width):
    rng = np.random.default_rng(seed)
    alpha = np.where(rng.random((height, width)) < fill, rng.random((height, width)), 0.0)
    try:
        camera = frame_view(matte(alpha), yaw=0, height=3.0)
    except InputError:
        return
    assert 0 <= camera.foot[0] <= width
    assert 16 <= camera.foot[1] <= height
    assert 3.0 / height <= camera.metres_per_pixel <= 3.0 / 16


def test_a_crown_down_to_the_ground_stands_below_its_own_middle():
    """The lowest rows of a conifer are one branch here and another there: they say nothing of the stem."""
    alpha = np.zeros((300, 240), np.float32)
    for row in range(20, 280):
        half = (row - 20) * 0.35
        alpha[row, int(120 - half) : int(120 + half) + 1] = 1.0
    alpha[262:280, :70] = 0.0
    camera = frame_view(matte(alpha), yaw=0, height=10.0)
    assert camera.foot[0] == pytest.approx(120.5, abs=3.0)
