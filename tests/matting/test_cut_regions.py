from itertools import product

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.matting.cut_regions import cut_regions


def energy(label, odds, right, down):
    border = (right[:, :-1] * np.abs(np.diff(label, axis=1))).sum()
    return border + (down[:-1] * np.abs(np.diff(label, axis=0))).sum() - (odds * label).sum()


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), price=st.floats(0.0, 3.0))
def test_no_region_costs_less(seed, price):
    rng = np.random.default_rng(seed)
    odds = rng.normal(0, 1, (3, 4)).astype(np.float32)
    right, down = (price * rng.random((3, 4)).astype(np.float32) for _ in range(2))
    found = energy(cut_regions(odds, right, down, rounds=3000), odds, right, down)
    best = min(
        energy(np.reshape(label, (3, 4)).astype(float), odds, right, down)
        for label in product((0, 1), repeat=12)
    )
    assert found <= best + 1e-2  # the solver stops after its rounds
    assert found >= best - 1e-4  # the convex form has no better minimum than the regions


def test_without_borders_every_pixel_decides_for_itself():
    odds = np.random.default_rng(0).normal(0, 1, (9, 7)).astype(np.float32)
    nothing = np.zeros_like(odds)
    label = cut_regions(odds, nothing, nothing, rounds=200)
    assert np.array_equal(label > 0.5, odds > 0)


def test_specks_vanish_and_holes_close():
    odds = np.full((40, 40), -1.0, np.float32)
    odds[8:32, 8:32] = 1.0
    odds[20, 20], odds[3, 3] = -3.0, 3.0
    price = np.ones_like(odds)
    label = cut_regions(odds, price, price, rounds=400)
    assert label[20, 20] > 0.5
    assert label[3, 3] < 0.5
    assert label[12:28, 12:28].min() > 0.5
