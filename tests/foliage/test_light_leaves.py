import numpy as np
import pytest

from flowtree.foliage.light_leaves import light_leaves

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
GREEN = np.array([0.12, 0.25, 0.06])


def brightness(color):
    return color @ LUMINANCE


def test_leaves_in_one_light_keep_their_colour():
    even = np.tile(GREEN, (50, 1))
    assert np.allclose(light_leaves(even), even)
    assert light_leaves(np.zeros((0, 3))).shape == (0, 3)


def test_shadows_become_weaker_and_what_is_bright_stays():
    shade = np.exp(np.linspace(-2.0, 1.0, 61))
    made = light_leaves(GREEN * shade[:, None])
    bright, lit = brightness(made), brightness(GREEN * shade[:, None])
    usual = np.median(lit)
    dark = lit < usual
    assert np.allclose(np.log(bright[dark] / usual), 0.5 * np.log(lit[dark] / usual))
    assert np.allclose(made[~dark], (GREEN * shade[:, None])[~dark])


def test_a_crown_at_dusk_becomes_brighter_and_never_as_bright_as_by_day():
    made = light_leaves(np.tile(0.05 * GREEN, (20, 1)))
    assert (brightness(made) > 2.0 * brightness(0.05 * GREEN)).all()
    assert (brightness(made) < 0.08).all()
    assert np.allclose(made / made[:, 1:2], GREEN / GREEN[1])


def test_rare_blue_comes_nearer_to_green_and_rare_red_stays():
    blue, red = np.array([0.1, 0.15, 0.3]), np.array([0.3, 0.1, 0.05])
    few = light_leaves(np.concatenate([np.tile(GREEN, (95, 1)), np.tile(blue, (5, 1))]))
    assert few[-1, 2] / few[-1, 1] < 0.5 * blue[2] / blue[1]
    assert np.allclose(few[0], GREEN)
    some = light_leaves(np.concatenate([np.tile(GREEN, (95, 1)), np.tile(red, (5, 1))]))
    assert some[-1, 0] / some[-1, 1] == pytest.approx(red[0] / red[1], rel=1e-6)


def test_black_leaves_have_a_colour():
    assert np.isfinite(light_leaves(np.zeros((5, 3)))).all()
