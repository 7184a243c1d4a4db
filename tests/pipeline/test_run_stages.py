"""The runner: order, views, cache, progress and cancelling, shown on arithmetic instead of trees."""

from __future__ import annotations

import threading

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.configuration import override_params
from flowtree.errors import CancelledError, InputError
from flowtree.params import Params
from flowtree.pipeline.cache import StageCache
from flowtree.pipeline.run_stages import run_stages
from flowtree.pipeline.stage import Job, Stage


class Sums:
    """Three stages that count how often they ran."""

    def __init__(self):
        self.ran = []
        self.stages = (
            Stage(
                "double", self.double, ("number", "unit"), ("doubled", "unit_seen"), each_view=True, share=2.0
            ),
            Stage("add", self.add, ("doubled",), ("sum",), params=("density",)),
            Stage("draw", self.draw, ("sum",), ("drawn",), seeded=True),
        )

    def double(self, job, number, unit):
        self.ran.append("double")
        return 2 * number, unit

    def add(self, job, doubled):
        self.ran.append("add")
        return sum(doubled) + (job.params.density.resolution or 0)

    def draw(self, job, total):
        self.ran.append("draw")
        return total + job.seed

    def run(self, numbers=(1, 2), *, seed=0, sets=(), **options):
        job = Job(override_params(Params(), sets), seed, "cpu")
        sources = {"number": tuple(numbers), "unit": ("m",) * len(numbers)}
        return run_stages(self.stages, sources, job, views=len(numbers), **options).values


def test_views_run_each_alone_and_meet_in_a_tuple():
    sums = Sums()
    made = sums.run()
    assert made["doubled"] == (2, 4)
    assert made["sum"] == 6
    assert sums.ran == ["double", "double", "add", "draw"]


def test_equal_views_are_computed_once():
    sums = Sums()
    assert sums.run((3, 3))["doubled"] == (6, 6)
    assert sums.ran.count("double") == 1


@pytest.mark.parametrize(
    ("change", "again"),
    [
        ({}, []),
        ({"numbers": (1, 5)}, ["double", "add", "draw"]),
        ({"sets": ["density.resolution=10"]}, ["add", "draw"]),
        ({"seed": 4}, ["draw"]),
        ({"sets": ["flow.particle_count=7"]}, []),
    ],
    ids=["nothing", "a view", "a parameter", "the seed", "a parameter nobody reads"],
)
def test_only_what_hangs_on_a_change_runs_again(change, again):
    sums, cache = Sums(), StageCache()
    sums.run(cache=cache)
    sums.ran.clear()
    made = sums.run(**change, cache=cache)
    assert sums.ran == again
    assert made == Sums().run(**change)


@settings(max_examples=25, deadline=None)
@given(
    runs=st.lists(
        st.tuples(st.tuples(st.integers(0, 2), st.integers(0, 2)), st.integers(0, 2), st.integers(4, 6)),
        max_size=8,
    ),
    capacity=st.integers(1, 4),
)
def test_a_cache_of_any_size_changes_no_result(runs, capacity):
    sums, cache = Sums(), StageCache(capacity)
    for numbers, seed, resolution in runs:
        arguments = {"numbers": numbers, "seed": seed, "sets": [f"density.resolution={resolution}"]}
        assert sums.run(**arguments, cache=cache) == Sums().run(**arguments)
        assert len(cache) <= capacity


def test_progress_rises_from_nothing_to_all(monkeypatch):
    monkeypatch.setenv("FLOWTREE_THREADS", "1")
    seen = []
    Sums().run(progress=lambda stage, share: seen.append((stage, share)))
    assert [stage for stage, _ in seen] == ["double", "double", "add", "draw", "draw"]
    shares = [share for _, share in seen]
    assert shares == pytest.approx([0.0, 0.25, 0.5, 0.75, 1.0])


def test_cancelling_stops_before_the_next_stage():
    sums = Sums()
    with pytest.raises(CancelledError, match="add"):
        sums.run(cancel=lambda: len(sums.ran) == 2)
    assert sums.ran == ["double", "double"]


def test_a_run_can_end_early():
    sums = Sums()
    assert "sum" not in sums.run(until="double")
    with pytest.raises(InputError, match=r"did you mean 'double'\?"):
        sums.run(until="doubel")


def test_what_does_not_hang_on_each_other_runs_side_by_side(monkeypatch):
    monkeypatch.setenv("FLOWTREE_THREADS", "2")
    meeting, caller, threads = threading.Barrier(2, timeout=20.0), threading.get_ident(), []

    def meet(job, number):
        meeting.wait()  # for ever, if the other stage began only after this one
        return number

    stages = (
        Stage("left", meet, ("number",), ("one",)),
        Stage("right", meet, ("number",), ("other",)),
        Stage("sum", lambda job, one, other: one + other, ("one", "other"), ("sum",)),
    )
    run = run_stages(
        stages,
        {"number": 4},
        Job(Params(), 0, "cpu"),
        views=1,
        progress=lambda name, share: threads.append(threading.get_ident()),
        cancel=lambda: threads.append(threading.get_ident()),
    )
    assert run.values["sum"] == 8
    assert list(run.seconds) == ["left", "right", "sum"]
    assert set(threads) == {caller}


@pytest.mark.parametrize("threads", ["1", "2", "8"])
def test_of_several_faults_that_of_the_first_stage_is_told(monkeypatch, threads):
    monkeypatch.setenv("FLOWTREE_THREADS", threads)
    later_failed, ran = threading.Event(), []

    def slow(job, number):
        if threads != "1":
            assert later_failed.wait(20.0)
        return number

    def refuse(job, number):
        raise InputError("the first of the table")

    def refuse_at_once(job, number):
        later_failed.set()
        raise InputError("a later one")

    stages = (
        Stage("slow", slow, ("number",), ("slow",)),
        Stage("refuse", refuse, ("slow",), ("refused",)),
        Stage("at once", refuse_at_once, ("number",), ("gone",)),
        Stage("after", lambda job, slow: ran.append(slow), ("slow",), ("after",)),
    )
    with pytest.raises(InputError, match="the first of the table"):
        run_stages(stages, {"number": 4}, Job(Params(), 0, "cpu"), views=1)
    assert not ran


@st.composite
def tables(draw):
    """Stages that each read some values of those before them, single ones and those of views."""
    stages, known = [], {"number": True, "unit": False}

    def stage(name, each_view):
        inputs = draw(st.lists(st.sampled_from(sorted(known)), min_size=1, max_size=3, unique=True))
        stages.append(
            Stage(
                name, lambda job, *values: (name, *values), tuple(inputs), (f"v{name}",), each_view=each_view
            )
        )
        known[f"v{name}"] = each_view

    for k in range(draw(st.integers(1, 7))):
        stage(str(k), draw(st.booleans()))
    return tuple(stages)


@settings(max_examples=25, deadline=None)
@given(stages=tables(), numbers=st.tuples(st.integers(0, 1), st.integers(0, 1)))
def test_any_number_of_threads_gives_the_same_values_and_rising_progress(stages, numbers):
    made = []
    for threads in ("1", "2", "5"):
        seen = []
        with pytest.MonkeyPatch.context() as patch:
            patch.setenv("FLOWTREE_THREADS", threads)
            run = run_stages(
                stages,
                {"number": numbers, "unit": ("m", "m")},
                Job(Params(), 0, "cpu"),
                views=2,
                progress=lambda name, share, seen=seen: seen.append(share),
            )
        made.append(run.values)
        assert seen == sorted(seen)
        assert seen[0] == 0.0
        assert seen[-1] == 1.0
        assert list(run.seconds) == [stage.name for stage in stages]
    assert made[0] == made[1] == made[2]


def test_what_each_stage_made_is_told_when_all_its_views_are_done():
    told = []
    values = Sums().run((1, 2), made=lambda stage, what: told.append((stage, what)))
    assert [stage for stage, _ in told] == ["double", "add", "draw"]
    assert told[0][1] == {"doubled": (2, 4), "unit_seen": ("m", "m")}
    assert told[2][1] == {"drawn": values["drawn"]}


def test_a_judgement_that_comes_out_the_same_changes_nothing_behind_it():
    ran = []

    def note(name, value):
        ran.append(name)
        return value

    stages = (
        Stage(
            "judge",
            lambda job: note("judge", job.params.flow.step < 0.05),
            (),
            ("slow",),
            params=("flow",),
            by_content=True,
        ),
        Stage("draw", lambda job, slow: note("draw", int(slow)), ("slow",), ("drawn",)),
    )
    cache = StageCache()
    for step, drawn in ((0.01, 1), (0.02, 1), (0.06, 0)):
        job = Job(override_params(Params(), [f"flow.step={step}"]), 0, "cpu")
        assert run_stages(stages, {}, job, views=1, cache=cache).values["drawn"] == drawn
    assert ran == ["judge", "draw", "judge", "judge", "draw"]


def test_a_twin_shares_its_stages_results():
    ran = []

    def double(job, number):
        ran.append(number)
        return 2 * number

    stages = (
        Stage("double", double, ("painted",), ("doubled",)),
        Stage("plain double", double, ("bare",), ("plain_doubled",), same_as="double"),
    )
    cache, job = StageCache(), Job(Params(), 0, "cpu")
    told = []
    for painted, made, again in ((3, (6, 6), [3]), (4, (8, 6), [4])):
        ran.clear()
        sources = {"painted": painted, "bare": 3}
        run = run_stages(stages, sources, job, views=1, cache=cache, made=lambda stage, _: told.append(stage))
        assert (run.values["doubled"], run.values["plain_doubled"]) == made
        assert list(run.seconds) == ["double", "plain double"]
        assert ran == again
    assert sorted(told) == 2 * ["double"] + 2 * ["plain double"]
