"""The rule by which twigs stand on a branch: spiral, lean, level, hang."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from flowtree.branches.find_twig_places import append_twigs, find_twig_places
from flowtree.branches.shape_twigs import shape_twigs
from flowtree.params import TwigParams
from tests.crowns import lone_branch

PLAIN = shape_twigs(1, side_twigs=0, angle=0.0, curl=0.0, random=np.random.default_rng(0))
BRANCH = lone_branch((1, 0, 0), nodes=8)


def places(branch=BRANCH, *, frequency=5.0, length=0.5, seed=0, **params):
    bears = np.arange(len(branch.parent)) > 1
    return find_twig_places(
        branch,
        PLAIN,
        bears=bears,
        frequency=frequency,
        length=length,
        height=8.0,
        params=TwigParams(plagiotropism=params.pop("plagiotropism", 0.0), rigidity=1.0, **params),
        seed=seed,
    )


def directions(branch, twigs):
    way = twigs.points[:, 0] - branch.points[twigs.node]
    return way / np.linalg.norm(way, axis=1, keepdims=True)


@pytest.mark.parametrize("divergence", [137.5, 90.0, 180.0])
def test_successive_twigs_turn_by_the_divergence_angle(divergence):
    twigs = places(frequency=40.0, divergence=divergence)
    way = directions(BRANCH, twigs)
    turn = np.arctan2(way[:, 2], way[:, 1])
    step = np.degrees(np.angle(np.exp(1j * np.diff(turn))))
    expected = min(divergence, 360 - divergence)
    assert np.median(np.abs(step)) == pytest.approx(expected, abs=10 if divergence < 180 else 25)


def test_twigs_lean_from_the_branch_by_the_angle():
    lean = np.degrees(np.arccos(directions(BRANCH, places(frequency=40.0, angle=50.0))[:, 0]))
    assert lean.min() >= 0.69 * 50
    assert lean.max() <= 1.21 * 50
    assert lean.mean() == pytest.approx(0.95 * 50, abs=3)


def test_plagiotropism_levels_twigs():
    steep, level = (np.abs(directions(BRANCH, places(plagiotropism=p))[:, 1]).mean() for p in (0.0, 1.0))
    assert steep > 0.2
    assert level < 1e-6


def test_frequency_and_length_are_kept():
    twigs = places(frequency=30.0, length=0.2)
    assert len(twigs.node) == pytest.approx(30.0 * 4.0, rel=0.1)
    long = np.linalg.norm(twigs.points[:, -1] - BRANCH.points[twigs.node], axis=1)
    assert long.mean() == pytest.approx(0.2 * (0.4 + 1.45) / 2, rel=0.1)


def test_what_is_not_rigid_hangs():
    stiff = places(frequency=20.0)
    soft = find_twig_places(
        BRANCH,
        PLAIN,
        bears=np.arange(len(BRANCH.parent)) > 1,
        frequency=20.0,
        length=0.5,
        height=8.0,
        params=TwigParams(plagiotropism=0.0, rigidity=0.2),
        seed=0,
    )
    fall = stiff.points[..., 1] - soft.points[..., 1]
    assert (np.diff(fall, axis=1) > 0).all()


def test_a_change_elsewhere_leaves_twigs_as_they_were():
    moved = BRANCH.points.copy()
    moved[-1] += 0.05
    other = replace(BRANCH, points=moved)
    one, two = places(), places(other)
    kept = one.node < len(BRANCH.parent) - 1
    assert np.array_equal(one.points[kept], two.points[two.node < len(BRANCH.parent) - 1])


def test_appended_twigs_keep_parents_first_and_what_was_there():
    twigs = places(frequency=20.0)
    made = append_twigs(BRANCH, PLAIN, twigs)
    assert (made.parent < np.arange(len(made.parent))).all()
    assert made.twig.sum() == 3 * len(twigs.node)
    assert np.array_equal(made.points[~made.twig], BRANCH.points)
    assert (made.radius[1:] <= made.radius[made.parent[1:]] * (1 + 1e-6)).all()


def test_opposite_twigs_come_in_pairs():
    twigs = places(frequency=20.0, whorl=2, divergence=90.0)
    way = directions(BRANCH, twigs)[:, 1:]
    assert len(way) % 2 == 0
    assert np.array_equal(twigs.node[::2], twigs.node[1::2])
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    assert np.median((way[::2] * way[1::2]).sum(axis=1)) < -0.8
