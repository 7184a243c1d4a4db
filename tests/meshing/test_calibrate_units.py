import numpy as np
import pytest

from flowtree.meshing.calibrate_units import calibrate_units


def calibrated(gap, twist=0.0, long=1.0, short=0.4, reach=2.0):
    column = [np.array([float(value)]) for value in (gap, twist, long, short, reach)]
    gap, twist, long, short, reach = column
    first, second, total = calibrate_units(gap, twist, (long, long), (short, short), reach)
    return first[0], second[0], total[0]


def test_units_far_apart_keep_their_lengths():
    assert calibrated(5.0) == (0.0, 0.0, 0.0)


def test_units_that_overlap_give_way_as_far_as_they_may():
    first, second, total = calibrated(-0.5)
    assert first == second
    assert -0.5 + first + second > 0.0
    assert first <= 0.6 + 1e-12
    assert np.isfinite(total)


def test_units_that_overlap_whatever_they_do_say_so():
    first, _, total = calibrated(-5.0)
    assert first == pytest.approx(0.6)
    assert np.isinf(total)


def test_a_twist_makes_a_narrow_gap_worse():
    totals = [calibrated(0.2, twist)[2] for twist in (0.0, 0.3, 0.7)]
    assert totals == sorted(totals)
    assert totals[0] < totals[2]


def test_the_wider_the_gap_the_less_it_costs():
    totals = [calibrated(gap)[2] for gap in (-0.8, 0.0, 0.5, 1.0, 2.5)]
    assert totals == sorted(totals, reverse=True)
