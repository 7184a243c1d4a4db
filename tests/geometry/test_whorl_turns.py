import numpy as np
import pytest

from flowtree.geometry.whorl_turns import whorl_turns


@pytest.mark.parametrize("whorl", [1, 2, 3, 5])
def test_members_of_a_whorl_stand_evenly_and_whorls_turn_by_the_divergence(whorl):
    turns = whorl_turns(np.arange(4 * whorl), whorl, 137.5).reshape(4, whorl)
    assert np.allclose(np.diff(turns[:, 0]), 137.5)
    assert np.allclose(np.diff(turns, axis=1), 360.0 / whorl)


def test_alternate_leaves_follow_the_spiral():
    assert np.array_equal(whorl_turns(np.arange(5), 1, 90.0), [0, 90, 180, 270, 360])
