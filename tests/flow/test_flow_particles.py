"""The record of a flow: complete, the same on any number of cores, and what a launch a phase gives."""

from __future__ import annotations

import dataclasses
import sys

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.errors import InputError
from flowtree.flow.flow_in_launches import flow_in_launches
from flowtree.flow.flow_particles import flow_particles
from tests.flows import chance_fields, chance_times, meeting, places, upload_fields, upload_times, waits

FLOW_PARTICLES = sys.modules[flow_particles.__module__]
LIMBS = pytest.mark.parametrize("limbs", [0, 1], ids=["pairs", "limbs"])
STEP = {"step": 0.03, "arrival": 0.1}


def starts(seed, count):
    return np.random.default_rng(seed).uniform([-0.6, 0.6, -0.6], [0.6, 1.8, 0.6], (count, 3)).astype("f4")


def flow(seed, count, force, *, steps=120, start_time=None, threads=2):
    return flow_particles(
        starts(seed, count), upload_fields(chance_fields(seed), "cpu"), force, **STEP, steps=steps,
        times=upload_times(chance_times(seed), "cpu"), start_time=start_time, threads=threads,
    )  # fmt: skip


def flow_by_launches(seed, count, force, *, steps=120, start_time=None):
    begin, _, _, latest = waits(start_time, steps, STEP["step"], count)
    return flow_in_launches(
        starts(seed, count), upload_fields(chance_fields(seed), "cpu"), force,
        upload_times(chance_times(seed), "cpu"), begin, latest=latest, steps=steps, **STEP,
    )  # fmt: skip


def same_bytes(one, other):
    pairs = zip(
        (one.points, one.particle, one.begin), (other.points, other.particle, other.begin), strict=True
    )
    ends = zip(
        (one.begin_step, one.end_step, one.joined),
        (other.begin_step, other.end_step, other.joined),
        strict=True,
    )
    return all(a.tobytes() == b.tobytes() and a.dtype == b.dtype for a, b in [*pairs, *ends])


@LIMBS
@settings(max_examples=6, deadline=None)
@given(seed=st.integers(0, 1000), count=st.sampled_from([1, 2, 40, 300]), waiting=st.booleans())
def test_everybody_is_recorded_once_a_step_while_under_way(limbs, seed, count, waiting):
    start_time = np.random.default_rng(seed).uniform(0, 0.4, count).astype("f4") if waiting else None
    record = flow(seed, count, meeting(limbs), steps=60, start_time=start_time)
    assert record.particle_steps == len(record.points) == len(record.particle) == len(record.step)
    assert np.isfinite(record.points).all()
    there = ~np.isnan(places(record.points, record.particle, record.begin, count)[..., 0])
    step = np.arange(len(there))[:, None]
    last = np.where(record.end_step < 0, len(there), record.end_step)
    assert np.array_equal(there, (record.begin_step >= 0) & (step >= record.begin_step) & (step <= last))
    assert there.sum() == record.particle_steps, "no particle twice"
    begun = record.begin_step >= 0
    first = places(record.points, record.particle, record.begin, count)[
        record.begin_step[begun], np.flatnonzero(begun)
    ]
    assert (first.astype("f4") == starts(seed, count)[begun]).all(), "each sets off where it starts"


@LIMBS
@pytest.mark.parametrize("count", [60, 400])
def test_who_joins_ends_in_one_that_goes_on_and_all_are_counted(limbs, count):
    record = flow(1, count, meeting(limbs), steps=400)
    joined, end = record.joined, record.end_step
    gone = np.flatnonzero(joined >= 0)
    assert len(gone) > count / 2
    later = np.where(end[joined[gone]] < 0, 10_000, end[joined[gone]])
    assert (end[gone] >= 0).all()
    assert (later >= end[gone]).all(), "whoever took one in was under way then"
    mass = np.ones(count, int)
    for i in gone[np.lexsort((gone, end[gone]))]:
        # Of those that join in one step nobody takes in: the order within it does not matter.
        mass[joined[i]] += mass[i]
    assert mass[joined < 0].sum() == count


@LIMBS
@pytest.mark.parametrize("count", [63, 64, 65, 159, 160, 161, 700])
def test_any_number_of_threads_gives_the_same_bytes(limbs, count):
    start_time = np.random.default_rng(2).uniform(0, 0.3, count).astype("f4") if count % 2 else None
    one, *others = (
        flow(2, count, meeting(limbs, reach=0.04), steps=40, start_time=start_time, threads=threads)
        for threads in (1, 2, 3, 5)
    )
    assert (one.joined >= 0).sum() > count / 10
    assert all(same_bytes(one, other) for other in others)


@LIMBS
def test_a_record_in_pieces_is_the_same_flow(monkeypatch, limbs):
    start_time = np.linspace(0, 0.5, 200).astype("f4")
    force = meeting(limbs, reach=0.03)
    whole = flow(3, 200, force, start_time=start_time)
    monkeypatch.setattr(FLOW_PARTICLES, "_BLOCK", 700)
    pieces = [flow(3, 200, force, start_time=start_time, threads=threads) for threads in (1, 3)]
    assert len(whole.blocks) == 1
    assert len(pieces[0].blocks) > 5
    assert same_bytes(*pieces)
    assert same_bytes(whole, pieces[0])


@LIMBS
@pytest.mark.parametrize("waiting", [False, True])
def test_equals_a_launch_a_phase(limbs, waiting):
    """Without attraction and with nobody near at first: the paths do not hang on the order of a step."""
    start_time = np.random.default_rng(9).uniform(0, 0.6, 40).astype("f4") if waiting else None
    force = meeting(limbs, reach=0.06, growth=0.01, attraction=0.0)
    one = flow(1, 40, force, start_time=start_time)
    other = flow_by_launches(1, 40, force, start_time=start_time)
    assert (one.joined >= 0).sum() > 5
    assert np.array_equal(one.begin_step, other.begin_step)
    assert np.array_equal(one.joined, other.joined)
    assert np.array_equal(one.end_step, other.end_step)
    assert one.particle_steps == other.particle_steps
    shared = min(len(one.begin), len(other.begin)) - 1
    ours, theirs = (places(r.points, r.particle, r.begin, 40)[:shared] for r in (one, other))
    # Rounding grows along a way of two metres.
    assert np.nanmax(np.abs(ours - theirs)) < 1e-4


@LIMBS
def test_a_launch_a_phase_gives_the_same_kind_of_flow(limbs):
    """With attraction: rounding grows into other late meetings."""
    force = meeting(limbs, reach=0.02)
    one, other = flow(1, 400, force), flow_by_launches(1, 400, force)
    early = (one.end_step >= 0) & (one.end_step < 6)
    assert (one.joined == other.joined)[early].mean() > 0.99
    assert abs((one.joined >= 0).mean() - (other.joined >= 0).mean()) < 0.02
    assert abs(one.particle_steps / other.particle_steps - 1) < 0.02
    assert np.allclose(one.points.mean(axis=0), other.points.mean(axis=0), atol=0.02)


def test_nobody_leaves_an_empty_record():
    record = flow_particles(
        np.zeros((0, 3), np.float32), upload_fields(chance_fields(0), "cpu"), meeting(0), **STEP, steps=5
    )
    assert record.particle_steps == len(record.points) == len(record.begin_step) == 0
    assert all(getattr(record, field.name) is not None for field in dataclasses.fields(record))


@LIMBS
def test_it_stops_at_the_last_step_with_some_under_way(limbs):
    record = flow(4, 50, meeting(limbs), steps=3)
    assert len(record.begin) == 4
    assert (record.end_step < 0).any()
    assert record.end_step.max() < 3


def test_who_never_sets_off_is_not_recorded():
    start_time = np.float32([0.0, 3.0])
    record = flow(4, 2, meeting(0), steps=10, start_time=start_time)
    assert record.begin_step.tolist() == [-1, 0]
    assert set(record.particle) == {1}


@pytest.mark.parametrize("bad", [{"start": np.full((3, 3), np.nan, "f4")}, {"steps": 0}])
def test_broken_input_is_refused(bad):
    fields = upload_fields(chance_fields(0), "cpu")
    given_ = {"start": starts(0, 3), "steps": 5} | bad
    start = given_.pop("start")
    with pytest.raises(InputError, match=next(iter(bad))):
        flow_particles(start, fields, meeting(0), **STEP, **given_)
