from dataclasses import replace

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.foliage.bark_likeness import bark_likeness, visible_limbs
from flowtree.model.matte import Matte
from tests.crowns import BARK_BROWN, CENTRE, LEAF_GREEN, ball_matte, camera_at, plane_of

CAMERA = camera_at(0.0)
RIGHT, UP = plane_of(CAMERA)
CROWN = np.hypot(RIGHT, UP - CENTRE) < 2.2


def with_limb(width):
    """A limb of bark that goes up through the crown, that many pixels wide."""
    matte = ball_matte(CAMERA, 0.9)
    limb = (np.abs(RIGHT - 0.5) < 0.025 * width) & CROWN
    color = np.where(limb[..., None], np.uint8(BARK_BROWN), matte.foreground)
    return limb, replace(matte, foreground=color)


def test_the_stem_and_limbs_are_like_bark_and_leaves_are_not():
    limb, matte = with_limb(5)
    found = bark_likeness(matte, CAMERA)
    assert found.dtype == np.float32
    assert (found[limb] > 0.99).all()
    assert (found[CROWN & ~limb] < 0.01).all()
    assert (found[(matte.alpha > 0.9) & (UP < 2)] > 0.99).all()


def test_limbs_are_seen_and_threads_are_not():
    for width, seen in ((5, True), (1, False)):
        limb, matte = with_limb(width)
        found = visible_limbs(matte, CAMERA)
        assert (found[limb].mean() > 0.8) == seen
        assert (found[CROWN & ~limb] < 0.01).all()


def test_where_all_is_of_one_colour_it_tells_nothing():
    matte = ball_matte(CAMERA, 0.9)
    dusk = replace(matte, foreground=np.full_like(matte.foreground, 30))
    for answer in (bark_likeness(dusk, CAMERA), visible_limbs(dusk, CAMERA)):
        assert not answer.any()


def test_without_a_stem_or_a_tree_it_tells_nothing():
    matte = ball_matte(CAMERA, 0.9)
    for alpha in (
        np.zeros_like(matte.alpha),
        np.where(UP < 2, 0, matte.alpha),
        np.where(UP > 2, 0, matte.alpha),
    ):
        assert not bark_likeness(replace(matte, alpha=alpha.astype(np.float32)), CAMERA).any()


@settings(max_examples=20, deadline=None)
@given(
    seed=st.integers(0, 10_000),
    shape=st.tuples(st.integers(1, 24), st.integers(1, 24)),
    foot=st.floats(-10, 40),
)
def test_any_matte_gives_shares(seed, shape, foot):
    rng = np.random.default_rng(seed)
    alpha = np.where(rng.random(shape) < 0.3, 0, rng.random(shape) * 1.2).clip(0, 1).astype(np.float32)
    matte = Matte(alpha, rng.choice(np.uint8([LEAF_GREEN, BARK_BROWN]), shape), "automatic")
    camera = replace(CAMERA, width=shape[1], height=shape[0], foot=(shape[1] / 2, foot))
    for answer in (bark_likeness(matte, camera), visible_limbs(matte, camera)):
        assert answer.shape == shape
        assert ((answer >= 0) & (answer <= 1)).all()
