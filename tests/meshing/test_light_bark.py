import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.meshing.light_bark import light_bark


@settings(max_examples=25, deadline=None)
@given(st.tuples(*[st.floats(0, 255)] * 3))
def test_dark_bark_gets_lighter_and_light_bark_stays(color):
    before = np.array(color)
    after = light_bark(before)
    assert ((after >= 0) & (after <= 255)).all()
    if before.min() > 90:
        assert np.array_equal(after, before)
    assert after.sum() >= before.sum() - 30
    assert light_bark(np.full(3, 10.0)).mean() > 25


def test_the_darker_the_nearer_to_grey_brown_and_the_order_of_brightness_stays():
    greys = [light_bark(np.full(3, level)) for level in (5.0, 20.0, 40.0, 60.0, 100.0)]
    assert [grey.mean() for grey in greys] == sorted(grey.mean() for grey in greys)
    spread = [np.ptp(grey) for grey in greys]
    assert spread == sorted(spread, reverse=True) or spread[-1] == 0
    assert np.ptp(light_bark(np.zeros(3))) > 3
