import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.density.known_depths import known_depths
from flowtree.model.camera import Camera
from flowtree.model.matte import Matte

GRID = {"left": -4.0, "cell": 0.5, "columns": 16, "rows": 10}


def _matte(alpha, unknown=None):
    return Matte(np.asarray(alpha, np.float32), np.zeros((*alpha.shape, 3), np.uint8), "test", unknown)


def _camera(alpha, foot=None):
    height, width = alpha.shape
    return Camera(0.0, 0.1, foot or (width / 2, float(height)), width, height)


def test_a_tree_with_room_around_it_is_known_everywhere():
    alpha = np.zeros((40, 60))
    alpha[5:39, 20:40] = 0.5
    depth, known = known_depths(_matte(alpha), _camera(alpha), **GRID)
    assert known.all()
    assert depth.max() == pytest.approx(np.log(2.0))
    assert (depth[:2] == 0).all(), "beyond the picture there is nothing"


@pytest.mark.parametrize("side", ["left", "right", "top", "bottom"])
def test_beyond_a_border_that_the_tree_touches_nothing_is_known(side):
    alpha = np.zeros((40, 60))
    alpha[10:20, 25:35] = 1.0
    part = {
        "left": (slice(10, 20), slice(0, 30)),
        "right": (slice(10, 20), slice(30, 60)),
        "top": (slice(0, 15), slice(25, 35)),
        "bottom": (slice(15, 40), slice(25, 35)),
    }[side]
    alpha[part] = 1.0
    camera = _camera(alpha, (30.0, 45.0))  # the ground lies half a metre below the picture
    _, known = known_depths(_matte(alpha), camera, **GRID)
    x = GRID["left"] + (np.arange(GRID["columns"]) + 0.5) * GRID["cell"]
    y = (np.arange(GRID["rows"]) + 0.5) * GRID["cell"]
    wanted = {
        "left": (x[:, None] < -3) & ((y > 2.5) & (y < 3.5)),
        "right": (x[:, None] > 3) & ((y > 2.5) & (y < 3.5)),
        "top": np.broadcast_to(y > 4.5, known.shape),
        "bottom": np.broadcast_to(y < 0.5, known.shape),
    }[side]
    assert np.array_equal(~known, wanted)


def test_a_haze_at_the_border_is_no_tree():
    alpha = np.full((40, 60), 0.2)
    assert known_depths(_matte(alpha), _camera(alpha), **GRID)[1].all()


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 10_000), share=st.floats(0, 1))
def test_what_lies_under_the_unknown_does_not_count(seed, share):
    rng = np.random.default_rng(seed)
    alpha = rng.random((40, 60))
    alpha[:, [0, -1]] = alpha[[0, -1]] = 0.0
    unknown = rng.random((8, 12)).repeat(5, 0).repeat(5, 1) < share
    other = np.where(unknown, rng.random((40, 60)), alpha)
    other[:, [0, -1]] = other[[0, -1]] = 0.0
    one, two = (known_depths(_matte(a, unknown), _camera(alpha), **GRID) for a in (alpha, other))
    assert np.array_equal(one[1], two[1])
    assert np.allclose(one[0], two[0])
    assert (one[0][~one[1]] == 0).all()
    assert np.isfinite(one[0]).all()
    whole = known_depths(_matte(alpha), _camera(alpha), **GRID)[0]
    clear = known_depths(_matte(alpha, np.zeros((40, 60), bool)), _camera(alpha), **GRID)
    assert np.array_equal(clear[0], whole)
