"""The search inside of `run_flow` finds what everybody against everybody finds."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import cKDTree

from tests.flows import chance_fields, chance_times, flow_swarm, meeting, particles

KINDS_OF_PLACES = ["even", "clustered", "coincident", "collinear", "plane", "far"]


def starts(seed, count, kind):
    """(n, 3) of a kind; "far": most in a crown, some a hundred times as far away."""
    rng = np.random.default_rng(seed)
    if kind in ("even", "clustered", "coincident", "collinear"):
        return particles(seed, count, kind).position
    place = particles(seed, count).position
    if kind == "plane":
        place[:, 1] = 1.0
    else:
        place[rng.random(count) < 0.3] *= rng.choice([-130.0, 100.0])
    return place


def assert_nearest(swarm, radius):
    """Compares the places that the last step found with those of float64, by their distance."""
    begin = swarm.begin
    last = int(swarm.progress[1])
    place = swarm.points[begin[last - 1] : begin[last]].astype(float)
    found = swarm.nearest[: len(place)]
    if not len(place):
        return
    gap = np.linalg.norm(place[:, None] - place[None], axis=2)
    np.fill_diagonal(gap, np.inf)
    best, ours = gap.min(axis=1), gap[np.arange(len(place)), found]
    some = found >= 0
    assert (found < len(place)).all()
    # Distances of float32 places are right to a few roundings, so ties and the radius are too.
    # A gap below 1e-19 has the square 0 in float32.
    assert (ours[some] <= best[some] * (1 + 1e-6) + 1e-18).all()
    assert (ours[some] < radius * (1 + 1e-6)).all()
    assert (best[~some] > radius * (1 - 1e-6)).all()


@pytest.mark.parametrize("kind", KINDS_OF_PLACES)
@settings(max_examples=6, deadline=None)
@given(
    seed=st.integers(0, 10_000),
    count=st.sampled_from([1, 2, 3, 17, 64, 65, 130, 500]),
    steps=st.integers(1, 4),
    radius=st.sampled_from([1e-3, 0.05, 0.3, 2.0, 1e4]),
    limbs=st.integers(0, 1),
    waiting=st.booleans(),
)
def test_the_nearest_is_exact(kind, seed, count, steps, radius, limbs, waiting):
    force = meeting(limbs, attraction_radius=radius, reach=1e-3)
    start_time = np.linspace(0, 0.09, count).astype("f4") if waiting else None
    swarm = flow_swarm(
        starts(seed, count, kind), chance_fields(seed), force, steps=steps, step=0.03,
        times=chance_times(seed), start_time=start_time,
    )  # fmt: skip
    assert_nearest(swarm, radius)


@pytest.mark.parametrize("limbs", [0, 1])
def test_the_nearest_stays_exact_while_many_join_and_arrive(limbs):
    start = starts(5, 500, "clustered")
    for steps in (5, 11, 30, 45):
        force = meeting(limbs, attraction_radius=0.3, reach=0.02)
        swarm = flow_swarm(start, chance_fields(5), force, steps=steps, step=0.03, times=chance_times(5))
        assert_nearest(swarm, 0.3)


@pytest.mark.parametrize("steps", [1, 3])
def test_the_nearest_of_very_many_is_exact(steps):
    """Many, so that some have their nearest at the edge of what the bound lets them search."""
    force = meeting(0, attraction_radius=2.0, reach=1e-4)
    start = np.random.default_rng(6).uniform([-0.6, 0.6, -0.6], [0.6, 1.8, 0.6], (8000, 3)).astype("f4")
    swarm = flow_swarm(start, chance_fields(6), force, steps=steps, step=0.03, times=chance_times(6))
    begin = swarm.begin
    place = swarm.points[begin[steps - 1] : begin[steps]].astype(float)
    ours = np.linalg.norm(place - place[swarm.nearest[: len(place)]], axis=1)
    assert np.allclose(ours, cKDTree(place).query(place, k=2)[0][:, 1], rtol=1e-5, atol=1e-7)


@settings(max_examples=20, deadline=None)
@given(
    places=st.lists(
        st.tuples(*[st.floats(-1e3, 1e3, width=32) | st.sampled_from([0.0, 1e-30, 1.0, 1e6])] * 3),
        min_size=1,
        max_size=80,
    )
)
def test_no_places_are_too_odd(places):
    force = meeting(0, attraction_radius=5.0, reach=1e-3)
    start = np.array(places, np.float32)
    swarm = flow_swarm(start, chance_fields(0), force, steps=1, step=0.01, times=chance_times(0))
    assert_nearest(swarm, 5.0)
