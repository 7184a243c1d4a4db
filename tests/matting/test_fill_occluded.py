import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.matting.fill_occluded import fill_occluded


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), height=st.integers(1, 30), width=st.integers(1, 30))
def test_what_is_known_stays_and_the_rest_lies_between(seed, height, width):
    rng = np.random.default_rng(seed)
    alpha = rng.random((height, width)).astype(np.float32)
    occluded = rng.random((height, width)) < rng.random()
    filled = fill_occluded(alpha, occluded)
    assert np.array_equal(filled[~occluded], alpha[~occluded])
    if not occluded.all():
        known = alpha[~occluded]
        assert filled.min() >= known.min() - 1e-5
        assert filled.max() <= known.max() + 1e-5


def test_a_post_before_a_crown_is_crown():
    alpha = np.zeros((40, 60), np.float32)
    alpha[:20] = 1.0
    occluded = np.zeros((40, 60), bool)
    occluded[:, 25:35] = True
    filled = fill_occluded(np.where(occluded, np.float32(0.3), alpha), occluded)
    assert filled[:12].min() > 0.8
    assert filled[28:].max() < 0.2
