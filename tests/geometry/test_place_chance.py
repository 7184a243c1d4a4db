import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.geometry.place_chance import place_chance, place_words


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 2**40), number=st.integers(-100, 100), places=st.lists(st.integers(0, 2**62)))
def test_a_place_has_its_number_whatever_else_is_there(seed, number, places):
    all_ = place_words(np.array([7, *places]), seed, number)
    assert all_[0] == place_words(np.array([7]), seed, number)[0]
    assert all_.dtype == np.uint64


@pytest.mark.parametrize("axis", ["place", "seed", "number"])
def test_numbers_are_even_and_neighbours_independent(axis):
    count = 20_000
    if axis == "place":
        chance = place_chance(np.arange(count), 1)
    elif axis == "number":
        chance = place_chance(np.full(count, 5), 1, np.arange(count))
    else:
        chance = np.concatenate([place_chance(np.array([5]), seed) for seed in range(count)])
    assert (chance >= 0).all()
    assert (chance < 1).all()
    counts = np.histogram(chance, 20, (0, 1))[0]
    # Chi squared of 19 degrees of freedom: above 44 once in a thousand.
    assert ((counts - count / 20) ** 2 / (count / 20)).sum() < 44
    assert abs(np.corrcoef(chance[1:], chance[:-1])[0, 1]) < 4 / np.sqrt(count)
