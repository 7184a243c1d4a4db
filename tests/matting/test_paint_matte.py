import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.errors import InputError
from flowtree.matting.paint_matte import paint_matte
from flowtree.model.edit import PaintedEdit
from flowtree.model.matte import Matte


def matte():
    alpha = np.zeros((20, 30), np.float32)
    alpha[5:15, 10:20] = 1.0
    alpha[5:15, 9] = 0.3
    foreground = np.zeros((20, 30, 3), np.uint8)
    foreground[5:15, 10:20] = (10, 200, 30)
    return Matte(alpha, foreground, "alpha channel")


def test_nothing_painted_changes_nothing():
    before = matte()
    assert paint_matte(before, PaintedEdit()) is before
    after = paint_matte(before, PaintedEdit(add=np.zeros((20, 30), np.float32)))
    assert after.alpha.tobytes() == before.alpha.tobytes()
    assert after.foreground.tobytes() == before.foreground.tobytes()


def test_added_density_unites_and_takes_the_nearest_colour():
    add = np.zeros((20, 30), np.float32)
    add[8, :] = 0.5
    after = paint_matte(matte(), PaintedEdit(add=add))
    assert after.alpha[8, 0] == pytest.approx(0.5)
    assert after.alpha[8, 9] == pytest.approx(1 - 0.7 * 0.5)
    assert after.alpha[8, 15] == 1.0
    assert after.foreground[8, 0].tolist() == [10, 200, 30]
    assert after.foreground[2, 0].tolist() == [0, 0, 0]


def test_erasing_takes_its_share():
    erase = np.full((20, 30), 0.25, np.float32)
    before = matte()
    after = paint_matte(before, PaintedEdit(erase=erase))
    assert np.allclose(after.alpha, 0.75 * before.alpha)
    assert after.foreground.tobytes() == before.foreground.tobytes()


def test_paint_says_what_is_behind_an_occluder():
    unknown = np.zeros((20, 30), bool)
    unknown[:, 12:18] = True
    before = Matte(matte().alpha, matte().foreground, "scribbles", unknown)
    layer = np.zeros((20, 30), np.float32)
    layer[:10], layer[10:12] = 0.8, 0.3
    for edit in (PaintedEdit(add=layer), PaintedEdit(erase=layer)):
        after = paint_matte(before, edit)
        assert not after.unknown[:10].any()
        assert np.array_equal(after.unknown[10:], unknown[10:])
    assert paint_matte(matte(), PaintedEdit(add=layer)).unknown is None


def test_painting_on_an_empty_matte_is_allowed():
    empty = Matte(np.zeros((4, 5), np.float32), np.zeros((4, 5, 3), np.uint8), "automatic")
    after = paint_matte(empty, PaintedEdit(add=np.ones((4, 5), np.float32)))
    assert (after.alpha == 1.0).all()


@pytest.mark.parametrize(
    "layer",
    [np.ones((3, 3), np.float32), np.full((20, 30), np.nan), np.full((20, 30), 1.5), np.full((20, 30), -0.1)],
)
def test_bad_layers_are_refused(layer):
    for edit in (PaintedEdit(add=layer), PaintedEdit(erase=layer)):
        with pytest.raises(InputError):
            paint_matte(matte(), edit)


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 2**16))
def test_alpha_stays_a_share_and_moves_the_right_way(seed):
    rng = np.random.default_rng(seed)
    alpha, add, erase = (rng.random((6, 7)).astype(np.float32) for _ in range(3))
    before = Matte(alpha, rng.integers(0, 255, (6, 7, 3)).astype(np.uint8), "automatic")
    added = paint_matte(before, PaintedEdit(add=add)).alpha
    erased = paint_matte(before, PaintedEdit(erase=erase)).alpha
    assert added.dtype == erased.dtype == np.float32
    assert (added >= alpha - 1e-6).all()
    assert (erased <= alpha).all()
    assert min(added.min(), erased.min()) >= 0.0
    assert max(added.max(), erased.max()) <= 1.0
