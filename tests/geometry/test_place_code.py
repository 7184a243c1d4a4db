import numpy as np

from flowtree.geometry.place_code import place_code


def test_places_have_their_own_numbers_whatever_else_there_is():
    points = np.random.default_rng(0).uniform(-5, 5, (500, 3))
    codes = place_code(points, 10.0)
    assert np.array_equal(codes[100:200], place_code(points[100:200], 10.0))
    assert len(np.unique(codes)) == 500
    assert (codes >= 0).all()


def test_the_same_place_of_a_larger_tree_has_the_same_number():
    points = np.random.default_rng(1).uniform(-1, 1, (50, 3))
    assert np.array_equal(place_code(points, 2.0), place_code(points * 4.0, 8.0))


def test_points_far_outside_break_nothing():
    assert (place_code(np.array([[1e9, -1e9, 0.0]]), 1.0) >= 0).all()
