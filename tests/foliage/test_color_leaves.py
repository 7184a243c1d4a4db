from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.foliage.color_leaves import color_leaves
from flowtree.foliage.spread_colors import spread_colors
from flowtree.geometry.srgb import LIGHT_OF_BYTE
from flowtree.model.matte import Matte
from tests.crowns import CENTRE, ball_matte, camera_at, plane_of

FRONT, SIDE = camera_at(0.0), camera_at(90.0)
SPOTS = np.array([0.0, CENTRE, 0.0]) + np.random.default_rng(0).uniform(-1, 1, (40, 3))


def painted(camera, color, alpha=0.8):
    """The ball in colours of its own, given for every pixel or for all."""
    matte = ball_matte(camera, alpha)
    return replace(matte, foreground=np.broadcast_to(np.uint8(color), matte.foreground.shape).copy())


def colored(points, mattes, cameras, **options):
    """Leaves coloured from mattes, as `place_leaves` does."""
    colors = [spread_colors(matte, camera) for matte, camera in zip(mattes, cameras, strict=True)]
    return color_leaves(points, mattes, colors, cameras, **options)


def test_an_even_colour_is_every_leafs():
    """Divided by the mean brightness of the texture that it is multiplied with."""
    made = colored(SPOTS, [painted(FRONT, (90, 140, 30))], [FRONT], variation=0)
    assert np.allclose(made, LIGHT_OF_BYTE[[90, 140, 30]] / 0.8, rtol=1e-3)


def test_halves_keep_their_colours():
    left = plane_of(FRONT)[0] < 0
    matte = painted(FRONT, np.where(left[..., None], (160, 30, 20), (40, 150, 30)))
    made = colored(SPOTS, [matte], [FRONT], variation=0)
    far = np.abs(SPOTS[:, 0]) > 0.2
    assert ((made[far, 0] > made[far, 1]) == (SPOTS[far, 0] < 0)).all()


def test_the_nearest_view_tells():
    mattes = [painted(FRONT, (200, 40, 40)), painted(SIDE, (40, 40, 200))]
    made = colored(SPOTS, mattes, [FRONT, SIDE], variation=0)
    assert ((made[:, 0] > made[:, 2]) == (SPOTS[:, 2] > SPOTS[:, 0])).all()


def test_a_view_that_shows_no_tree_there_tells_nothing():
    mattes = [painted(FRONT, (200, 40, 40), alpha=0.0), painted(SIDE, (40, 40, 200))]
    made = colored(SPOTS, mattes, [FRONT, SIDE], variation=0)
    assert (made[:, 2] > made[:, 0]).all()


def test_what_shines_through_half_covered_pixels_counts_little():
    """Half of the pixels hold a tenth of tree and much sky: the others tell the colour."""
    matte = painted(FRONT, (60, 130, 40))
    thin = np.indices(matte.alpha.shape).sum(axis=0) % 2 == 0
    color = np.where(thin[..., None], np.uint8([200, 210, 255]), matte.foreground)
    mixed = Matte(np.where(thin, 0.15, 1.0).astype(np.float32) * (matte.alpha > 0), color, "trimap")
    made = colored(SPOTS, [mixed], [FRONT], variation=0)
    assert np.allclose(made, LIGHT_OF_BYTE[[60, 130, 40]] / 0.8, atol=0.02)


def test_sky_in_gaps_that_the_matte_closed_bleaches_no_leaf():
    """A tenth of a dark grey-green crown is white; linear light would make all of it pale."""
    matte = painted(FRONT, (44, 50, 40), alpha=1.0)
    noise = np.random.default_rng(2)
    color = np.clip(matte.foreground + noise.normal(0.0, 6.0, (*matte.alpha.shape, 1)), 0, 255)
    color[noise.random(matte.alpha.shape) < 0.1] = 245
    made = colored(SPOTS, [replace(matte, foreground=color.astype(np.uint8))], [FRONT], variation=0)
    assert np.allclose(made.mean(axis=0), LIGHT_OF_BYTE[[44, 50, 40]] / 0.8, rtol=0.8)


def test_variation_is_of_brightness_alone_and_as_wide_as_asked():
    spots = np.repeat(SPOTS, 50, axis=0)
    made = colored(spots, [painted(FRONT, (90, 140, 60))], [FRONT], variation=0.12, seed=3)
    assert made[:, 1].std() / made[:, 1].mean() == pytest.approx(0.12, rel=0.1)
    assert np.allclose(made[:, 0] / made[:, 1], made[0, 0] / made[0, 1], rtol=1e-4)
    again = colored(spots, [painted(FRONT, (90, 140, 60))], [FRONT], variation=0.12, seed=3)
    other = colored(spots, [painted(FRONT, (90, 140, 60))], [FRONT], variation=0.12, seed=4)
    assert made.tobytes() == again.tobytes() != other.tobytes()


@settings(max_examples=20, deadline=None)
@given(
    seed=st.integers(0, 10_000),
    shape=st.tuples(st.integers(1, 20), st.integers(1, 20)),
    variation=st.floats(0, 1),
    count=st.integers(0, 10),
)
def test_any_picture_and_place_gives_a_colour(seed, shape, variation, count):
    rng = np.random.default_rng(seed)
    camera = replace(FRONT, width=shape[1], height=shape[0], foot=(shape[1] / 2, shape[0] * 0.9))
    matte = Matte(
        (rng.random(shape) * (rng.random(shape) < 0.6)).astype(np.float32),
        rng.integers(0, 256, (*shape, 3), np.uint8),
        "automatic",
    )
    made = colored(rng.normal(0, 3, (count, 3)), [matte], [camera], variation=variation, seed=seed)
    assert made.shape == (count, 3)
    assert made.dtype == np.float32
    assert np.isfinite(made).all()
    assert ((made >= 0) & (made <= 1)).all()


def test_empty_picture_beside_the_tree_changes_nothing():
    matte = painted(FRONT, (90, 140, 30))
    wide = replace(
        matte,
        alpha=np.pad(matte.alpha, ((0, 0), (30, 50))),
        foreground=np.pad(matte.foreground, ((0, 0), (30, 50), (0, 0))),
    )
    camera = replace(FRONT, foot=(FRONT.foot[0] + 30, FRONT.foot[1]), width=FRONT.width + 80)
    own, padded = spread_colors(matte, FRONT), spread_colors(wide, camera)
    assert padded.shape == (*wide.alpha.shape, 3)
    assert np.array_equal(padded[:, 30:-50], own)


def test_an_empty_picture_has_no_colour():
    matte = painted(FRONT, (90, 140, 30), alpha=0.0)
    assert spread_colors(matte, FRONT).shape == (*matte.alpha.shape, 3)
