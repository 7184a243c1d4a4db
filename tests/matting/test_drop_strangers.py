import numpy as np

from flowtree.matting.drop_strangers import drop_strangers


def scene(*patches):
    """A tree of 200 x 100 pixels and patches (top, left, height, width) beside it."""
    alpha = np.zeros((260, 400), np.float32)
    alpha[30:230, 100:200] = 0.8
    for top, left, height, width in patches:
        alpha[top : top + height, left : left + width] = 0.7
    return alpha


def test_a_small_patch_far_from_the_tree_goes():
    assert np.array_equal(drop_strangers(scene((50, 300, 30, 10))), scene())


def test_what_is_near_large_or_the_tree_itself_stays():
    for patch in ((50, 203, 30, 10), (50, 300, 60, 40)):
        assert np.array_equal(drop_strangers(scene(patch)), scene(patch))
    nothing = np.zeros((20, 20), np.float32)
    assert drop_strangers(nothing) is nothing


def test_what_a_person_says_is_tree_stays():
    alpha = scene((50, 300, 30, 10), (150, 350, 30, 10))
    claimed = np.zeros(alpha.shape, bool)
    claimed[60, 305] = True
    assert np.array_equal(drop_strangers(alpha, claimed), scene((50, 300, 30, 10)))
