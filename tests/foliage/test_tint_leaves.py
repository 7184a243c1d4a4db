import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.errors import InputError
from flowtree.foliage.tint_leaves import tint_leaves

CODE = np.arange(4000)


def tint(color="auto", variation=0.1, shape="broad", seed=0):
    return tint_leaves(CODE, CODE * 0, shape=shape, color=color, variation=variation, seed=seed)


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 255), st.floats(0, 1), st.integers(0, 1000))
def test_any_colour_and_variation_stay_light(level, variation, seed):
    made = tint(f"#{level:02x}{level:02x}{level:02x}", variation, seed=seed)
    assert made.dtype == np.float32
    assert ((made >= 0) & (made <= 1)).all()


def test_the_mean_is_the_colour_and_the_variation_is_the_given_one():
    made = tint("#6f8a48", 0.12)
    assert np.allclose(0.8 * made.mean(axis=0), [0.1589, 0.2542, 0.0648], rtol=0.03)
    bright = made.mean(axis=1)
    assert bright.std() / bright.mean() == pytest.approx(0.12, rel=0.25)
    assert np.ptp(tint(variation=0.0), axis=0).max() < 1e-6


def test_leaves_vary_from_green_to_yellow():
    made = tint(variation=0.2)
    warmth = made[:, 0] / made[:, 2]
    assert warmth.std() / warmth.mean() > 0.08


def test_shapes_have_usual_colours_and_wrong_ones_are_refused():
    assert tint(shape="blossom").mean() > 2 * tint(shape="broad").mean()
    with pytest.raises(InputError, match="leaf color: must be auto or #rrggbb"):
        tint("green")
