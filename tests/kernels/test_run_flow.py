"""The whole flow, `run_flow`, against its float64 twin, and the laws that it keeps."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.kernels.swarm import MASS, U, W, X, Z
from tests.flows import chance_fields, chance_times, flow_lists, flow_swarm, flow_twin, meeting, places

LIMBS = pytest.mark.parametrize("limbs", [0, 1], ids=["pairs", "limbs"])


def starts(seed, count):
    """(n, 3) in a crown."""
    return np.random.default_rng(seed).uniform([-0.6, 0.6, -0.6], [0.6, 1.8, 0.6], (count, 3)).astype("f4")


def still(yaws=(0.0, 90.0)):
    """Fields that lead nowhere, without a route."""
    fields = chance_fields(0, yaws)
    fields.vectors[:], fields.pull = 0.0, 0.0
    return fields


def straight():
    """Fields that lead straight down."""
    fields = still()
    fields.vectors[..., 1] = -1.0
    return fields


def record(swarm):
    """Points, particles, and where each step begins, of a kernel's swarm."""
    begin = swarm.begin[: swarm.progress[1] + 1]
    return swarm.points[: begin[-1]], swarm.particle[: begin[-1]], begin


@LIMBS
@pytest.mark.parametrize("route", [False, True], ids=["fields", "route"])
@settings(max_examples=3, deadline=None)
@given(seed=st.integers(0, 10_000), count=st.integers(1, 32), waiting=st.booleans())
def test_equals_its_twin(limbs, route, seed, count, waiting):
    start, fields, times = starts(seed, count), chance_fields(seed), chance_times(seed)
    fields.pull *= route
    start_time = np.random.default_rng(seed).uniform(0, 0.5, count).astype("f4") if waiting else None
    given_ = (start, fields, meeting(limbs))
    settings_ = {"steps": 16, "step": 0.03, "times": times, "start_time": start_time}
    fast, slow = flow_swarm(*given_, **settings_), flow_twin(*given_, **settings_)
    ours = places(*record(fast), count)
    exact = places(slow.points, slow.particle, slow.begin[: slow.progress[1] + 1], count)
    shared = min(len(ours), len(exact))
    wrong = np.nanmax(np.abs(ours[:shared] - exact[:shared]), axis=2, initial=0.0)
    # A rounding of float32 a step, as long as all meet the same: a threshold missed by a rounding is rare.
    differs = (fast.end_step != slow.end_step) | (fast.joined != slow.joined)
    if not differs.any():
        assert np.array_equal(fast.progress[:4], slow.progress[:4])
        assert np.array_equal(np.isnan(ours), np.isnan(exact))
    early = np.minimum(fast.end_step.astype("u4"), slow.end_step.astype("u4")) < 5
    assert not (differs & early).any(), "merges of the first steps"
    assert (wrong[:5] < 2e-5).all()
    # Later a different neighbour, chosen by a rounding, may lead somebody astray.
    assert np.quantile(wrong, 0.9) < 1e-4


@LIMBS
def test_equals_its_twin_over_a_long_way(limbs):
    start, fields, times = starts(1, 40), chance_fields(1, closeness=0.3), chance_times(1)
    start_time = np.linspace(0, 0.4, 40).astype("f4") if limbs else None
    settings_ = {"steps": 60, "step": 0.03, "times": times, "start_time": start_time}
    fast = flow_swarm(start, fields, meeting(limbs), **settings_)
    slow = flow_twin(start, fields, meeting(limbs), **settings_)
    assert (slow.joined >= 0).sum() > 12
    # One or two late merges may go to another: who meets whom by then hangs on a rounding.
    assert (fast.joined == slow.joined).mean() > 0.9
    assert (np.abs(fast.end_step - slow.end_step) <= 1).mean() > 0.9


def test_the_step_is_of_fourth_order():
    fields = chance_fields(4, size=2)  # one cell: bilinear, so smooth everywhere
    fields.corner[:], fields.cell[:] = [-3.0, -3.0], [3.0, 4.0]
    fields.vectors[..., 1] -= 1.5  # far from zero
    fields.pull = 0.0
    force = meeting(0, response=0.3, attraction=0.0)
    start, times, way = np.float32([[0.3, 1.9, -0.2]]), chance_times(4), 1.2

    def after(flow, steps):
        swarm = flow(start, fields, force, steps=steps + 1, step=way / steps, times=times, arrival=0.01)
        points = swarm.points
        return points[steps].astype(float)

    exact = after(flow_twin, 64 * 8)
    errors = np.array([np.linalg.norm(after(flow_swarm, steps) - exact) for steps in (4, 8, 16, 64)])
    orders = np.log2(errors[:2] / errors[1:3])
    assert (orders > 3.7).all(), (errors, orders)
    assert errors[3] < 1e-6, "what rounding leaves"


def test_a_lone_particle_reaches_unit_speed():
    settings_ = {"steps": 30, "step": 0.03, "times": chance_times(0)}
    swarm = flow_swarm(np.float32([[0.1, 1.7, 0.2]]), straight(), meeting(0), **settings_)
    points = record(swarm)[0].astype(float)
    speed = np.linalg.norm(np.diff(points, axis=0), axis=1) / 0.03
    assert (np.diff(speed) > -1e-4).all()
    assert abs(speed[-1] - 1.0) < 1e-3


def put(places_, velocities, masses):
    """What makes a swarm begin with these particles under way."""

    def prepare(swarm, left):
        count = len(masses)
        left[X : Z + 1, :count] = np.transpose(places_)
        left[U : W + 1, :count] = np.transpose(velocities)
        left[MASS, :count] = masses
        swarm.number[:] = np.arange(count)
        swarm.nearest[:] = -1
        swarm.cell[:] = 0
        swarm.progress[:] = count, 0, count, 0, 0

    return prepare


HELD = {"steps": 1, "step": 0.01, "times": chance_times(0)}


@pytest.mark.parametrize(
    ("limbs", "masses"), [(0, (3, 1)), (1, (3, 1)), (1, (2, 5, 1)), (0, (1, 1)), (1, (4, 4, 4))]
)
def test_mass_and_momentum_are_kept(limbs, masses):
    count = len(masses)
    host = int(np.argmax(masses))
    place = np.array([[0.53, 1.0, 0.1], [0.5, 1.03, 0.1], [0.5, 1.0, 0.13]])[:count]
    place[host] = [0.5, 1.0, 0.1]  # nearer to both than they are to each other
    velocity = np.array([[0.4, -0.8, 0.0], [0.0, -0.2, 0.6], [-1.0, 0.3, 0.2]])[:count]
    force = meeting(limbs, attraction=0.0, response=1e9)  # nothing turns them within the step
    began = put(place, velocity, masses)
    swarm, left = flow_lists(np.float32(place), still(), force, **HELD, prepare=began)
    there = np.flatnonzero(swarm.cell >= 0)
    weight = np.array(masses) / sum(masses)
    assert swarm.number[there].tolist() == [host]
    after = left[:, there[0]]
    assert after[MASS] == sum(masses)
    assert np.allclose(after[U : W + 1], weight @ velocity, atol=1e-6)
    assert np.allclose(after[X : Z + 1], weight @ place + 0.01 * (weight @ velocity), atol=1e-6)
    assert swarm.joined.tolist() == [-1 if i == host else host for i in range(count)]
    assert swarm.end_step.tolist() == [-1 if i == host else 0 for i in range(count)]


def test_by_the_paper_only_mutual_neighbours_join():
    place = np.array([[0.5, 1.0, 0.1], [0.53, 1.0, 0.1], [0.5, 1.04, 0.1]])
    force = meeting(0, attraction=0.0, response=1e9)
    swarm = flow_swarm(np.float32(place), still(), force, **HELD, prepare=put(place, 0 * place, [1, 2, 9]))
    assert swarm.joined.tolist() == [1, -1, -1]


def test_who_is_to_join_one_that_joins_another_waits():
    """A chain: only its heavier half becomes one in the first step."""
    place = np.array([[0.5, 1.0, 0.1], [0.58, 1.0, 0.1], [0.66, 1.0, 0.1]])
    force = meeting(1, growth=0.0, attraction=0.0, response=1e9)
    swarm = flow_swarm(np.float32(place), still(), force, **HELD, prepare=put(place, 0 * place, [1, 2, 3]))
    assert swarm.joined.tolist() == [-1, 2, -1]


def edge_places(kind):
    rng = np.random.default_rng(1)
    return {
        "one": [[0.1, 1.0, 0.2]],
        "two": [[0.1, 1.0, 0.2], [0.15, 1.0, 0.2]],
        "one point": np.tile([0.1, 1.0, 0.2], (70, 1)),
        "outside": rng.uniform(-40, 40, (30, 3)),
        "under the ground": rng.uniform([-1, -2, -1], [1, -0.1, 1], (30, 3)),
        "at the foot": np.zeros((5, 3)),
        "around the foot": rng.normal(0, 1e-3, (30, 3)),
    }[kind]


EDGES = ["one", "two", "one point", "outside", "under the ground", "at the foot", "around the foot"]


@LIMBS
@pytest.mark.parametrize("kind", EDGES)
@pytest.mark.parametrize("lead", ["fields", "nothing", "route"])
def test_wherever_and_whatever_flows_it_stays_finite_and_ends(limbs, kind, lead):
    start = np.asarray(edge_places(kind), np.float32)
    fields = chance_fields(2) if lead != "nothing" else still()
    if lead == "route":
        fields.vectors[:] = 0.0
    swarm = flow_swarm(start, fields, meeting(limbs), steps=80, step=0.05, times=chance_times(2))
    points, particle, begin = record(swarm)
    assert np.isfinite(points).all()
    assert len(begin) - 1 <= 80
    end, joined = swarm.end_step, swarm.joined
    assert (end[joined >= 0] >= 0).all()
    if "foot" in kind:
        assert (end >= 0).all()
    if kind == "one point":
        assert (joined < 0).sum() == 1
    for k in range(len(begin) - 1):
        assert len(set(particle[begin[k] : begin[k + 1]])) == begin[k + 1] - begin[k]


def test_the_first_step_holds_the_starts_to_the_bit():
    """The sorted places are the record."""
    start = starts(3, 200)
    swarm = flow_swarm(start, chance_fields(3), meeting(0), steps=2, step=0.03, times=chance_times(3))
    points, particle, begin = record(swarm)
    assert points[: begin[1]][np.argsort(particle[: begin[1]])].tobytes() == start.tobytes()
