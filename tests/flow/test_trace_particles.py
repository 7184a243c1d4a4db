"""Whatever flows: every particle is connected to the root."""

import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.errors import InputError
from flowtree.flow.trace_particles import trace_particles
from flowtree.geometry.parent_array import sum_to_root
from flowtree.model.field import DirectionField
from flowtree.model.volume import DensityVolume
from flowtree.params import FlowParams
from tests.flows import DEVICES, cone_volume, stem_field

CONE = cone_volume()
STEM = [stem_field(0.0), stem_field(90.0)]
FEW = FlowParams(particle_count=300)


def assert_one_tree(traces, count):
    n = len(traces.parent)
    assert traces.parent[0] == -1
    assert (traces.parent[1:] >= 0).all()
    assert (traces.parent < np.arange(n)).all()
    assert (traces.points[0] == 0).all()
    assert np.isfinite(traces.points).all()
    assert traces.particles[0] == count
    # Every particle starts at one node, and from there on every node counts it.
    behind = np.zeros(n, int)
    np.add.at(behind, traces.parent[1:], traces.particles[1:])
    own = traces.particles - behind
    assert (own >= 0).all()
    assert own.sum() == count
    assert np.array_equal(sum_to_root(traces.parent, own), traces.particles)
    assert (traces.particles[np.bincount(traces.parent[1:], minlength=n) == 0] >= 1).all()
    assert [a.dtype for a in (traces.parent, traces.points, traces.particles, traces.step)] == [
        np.int32, np.float32, np.int32, np.int32,
    ]  # fmt: skip


@st.composite
def inputs(draw):
    """A volume anywhere of any shape, and fields that may be random, zero, uphill or in conflict."""
    rng = np.random.default_rng(draw(st.integers(0, 10_000)))
    shape = draw(st.tuples(*[st.integers(1, 9)] * 3))
    density = rng.random(shape).astype(np.float32) * draw(st.sampled_from([1e-30, 1.0, 1e30]))
    density[rng.random(shape) < draw(st.sampled_from([0.0, 0.5, 0.95]))] = 0.0
    density[tuple(rng.integers(0, shape))] = 1.0
    origin = np.float32(draw(st.sampled_from([(-1, 0, -1), (3, 5, 0), (0, -4, 0), (200, 0, 0), (0, 0, 0)])))
    volume = DensityVolume(density, origin, draw(st.sampled_from([1e-3, 0.2, 30.0])))
    size = draw(st.integers(2, 8))
    fields = []
    for yaw in draw(st.lists(st.sampled_from([0.0, 90.0, 180.0, 33.0]), min_size=1, max_size=3)):
        vectors = rng.normal(0, 1, (size, size, 2))
        kind = draw(st.sampled_from(["random", "zero", "up", "down", "across"]))
        if kind != "random":
            vectors[:] = {"zero": (0, 0), "up": (0, 1), "down": (0, -1), "across": (1, 0)}[kind]
        vectors /= np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1.0)
        cell = np.float32([volume.voxel, volume.voxel])
        fields.append(DirectionField(vectors.astype(np.float32), origin[:2], cell, yaw))
    return volume, fields


@settings(max_examples=25, deadline=None)
@given(data=inputs(), count=st.sampled_from([1, 2, 3, 40]), seed=st.integers(0, 3))
def test_every_particle_is_connected_to_the_root_whatever_flows(data, count, seed):
    params = FlowParams(particle_count=count, step=0.02)
    assert_one_tree(trace_particles(*data, params=params, seed=seed), count)


@settings(max_examples=12, deadline=None)
@given(
    step=st.floats(0.004, 0.1),
    attraction=st.floats(0, 20),
    radius=st.floats(0, 1),
    join=st.floats(1e-9, 0.5),
    growth=st.floats(0, 0.1),
    response=st.floats(0.001, 1),
    inertia=st.floats(0, 1),
    pace=st.floats(0, 100),
)
def test_every_parameter_in_its_range_gives_one_tree(
    step, attraction, radius, join, growth, response, inertia, pace
):
    params = FlowParams(
        particle_count=60, step=step, attraction=attraction, attraction_radius=radius, join_distance=join,
        join_growth=growth, response=response, inertia=inertia, pace=pace,
    )  # fmt: skip
    assert_one_tree(trace_particles(CONE, STEM, params=params), 60)


def test_all_in_one_point_is_one_stem():
    volume = DensityVolume(np.ones((1, 1, 1), np.float32), np.float32([0.2, 1.0, 0.2]), 1e-6)
    traces = trace_particles(volume, STEM, params=FEW)
    assert_one_tree(traces, 300)
    at_half = (traces.points[1:, 1] > 0.5) & (traces.points[traces.parent[1:], 1] <= 0.5)
    assert at_half.sum() == 1


@pytest.mark.parametrize("device", DEVICES)
def test_a_crown_over_a_stem_becomes_a_tree_with_one_trunk(device):
    traces = trace_particles(CONE, STEM, params=FEW, device=device)
    assert_one_tree(traces, 300)
    height, above, below = 2.0, traces.points[1:, 1], traces.points[traces.parent[1:], 1]
    crossing = np.flatnonzero((above > 0.1 * height) & (below <= 0.1 * height)) + 1
    assert traces.particles[crossing].max() > 0.95 * 300, "one trunk carries nearly all"
    trunk = traces.points[1:][above < 0.25 * height]
    assert np.hypot(trunk[:, 0], trunk[:, 2]).max() < 0.15 * height
    steps = np.linalg.norm(traces.points[1:] - traces.points[traces.parent[1:]], axis=1)
    assert steps.max() < 0.1 * height, "nothing is wired straight to the foot"
    later = traces.step[traces.parent[1:]] - traces.step[1:]
    # Who joins one that joins another in the same step is recorded in that step.
    assert (later >= 0).all(), "the step falls toward the tips"
    assert (later > 0).mean() > 0.99
    stems = np.flatnonzero(traces.parent == 0)
    assert traces.particles[stems].max() > 0.97 * 300


def test_a_particle_in_the_trunk_goes_down():
    density = np.zeros((5, 20, 5), np.float32)
    density[2] = np.eye(1, 5, 2)
    volume = DensityVolume(density, np.float32([-0.25, 0, -0.25]), 0.1)
    traces = trace_particles(volume, STEM, params=FlowParams(particle_count=1))
    y = traces.points[:, 1]
    assert (np.diff(y) >= -1e-6).all(), "from the foot up to the seed"


@pytest.mark.parametrize("count", [300, 900])
def test_equal_seeds_give_equal_bytes_on_any_number_of_cores(monkeypatch, count):
    params = FlowParams(particle_count=count)
    results = [trace_particles(CONE, STEM, params=params, seed=5, threads=threads) for threads in (1, 2, 3)]
    monkeypatch.setenv("FLOWTREE_THREADS", "2")
    results.append(trace_particles(CONE, STEM, params=params, seed=5))
    for other in results[1:]:
        for a, b in zip(dataclasses.astuple(results[0]), dataclasses.astuple(other), strict=True):
            assert a.tobytes() == b.tobytes()


def test_other_seeds_give_similar_but_different_trees():
    one, two = (trace_particles(CONE, STEM, params=FEW, seed=seed) for seed in (0, 1))
    assert one.points.shape != two.points.shape or not np.array_equal(one.points, two.points)
    assert 0.7 < len(one.parent) / len(two.parent) < 1.4
    assert np.allclose(one.points.mean(axis=0), two.points.mean(axis=0), atol=0.15)


def test_the_seeds_are_the_tips_own_points():
    traces = trace_particles(CONE, STEM, params=FlowParams(particle_count=40))
    tips = np.setdiff1d(np.arange(len(traces.parent)), traces.parent)
    inside = ((traces.points[tips] - CONE.origin) / CONE.voxel).astype(int)
    assert (CONE.density[tuple(inside.T)] > 0).all()


BROKEN_FIELDS = {
    "none": [],
    "not alike": [STEM[0], stem_field(90.0, size=7)],
    "NaN": [dataclasses.replace(STEM[0], vectors=STEM[0].vectors * np.float32(np.nan))],
    "too long": [dataclasses.replace(STEM[0], vectors=STEM[0].vectors * 2)],
    "one cell": [stem_field(0.0, size=1)],
    "no size": [dataclasses.replace(STEM[0], cell=np.zeros(2, np.float32))],
    "origin": [dataclasses.replace(STEM[0], origin=np.float32([np.inf, 0]))],
    "yaw": [dataclasses.replace(STEM[0], yaw=float("nan"))],
}


@pytest.mark.parametrize("kind", BROKEN_FIELDS)
def test_broken_fields_are_refused(kind):
    with pytest.raises(InputError, match="field"):
        trace_particles(CONE, BROKEN_FIELDS[kind], params=FEW)


@pytest.mark.parametrize(
    "change",
    [
        {"density": np.zeros((4, 4, 4), np.float32)},
        {"density": np.zeros((0, 4, 4), np.float32)},
        {"density": np.full((4, 4, 4), np.nan, np.float32)},
        {"density": np.full((4, 4, 4), -1.0, np.float32)},
        {"density": np.ones((4, 4), np.float32)},
        {"voxel": 0.0},
        {"voxel": float("inf")},
        {"origin": np.float32([0, np.nan, 0])},
    ],
)
@pytest.mark.parametrize("count", [None, 10])
def test_a_broken_volume_is_refused(change, count):
    with pytest.raises(InputError, match="volume"):
        trace_particles(dataclasses.replace(CONE, **change), STEM, params=FlowParams(particle_count=count))
