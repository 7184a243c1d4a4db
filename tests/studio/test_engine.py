"""What the engine makes of what its workers say, without any worker."""

from __future__ import annotations

from dataclasses import replace

import pytest

from flowtree.project.document_state import DocumentState, DrawnPhoto
from flowtree.studio.engine import Engine
from flowtree.studio.job import Message


class Idle:
    """A worker that only remembers its jobs."""

    def __init__(self, *_, **__):
        self.jobs = []

    def submit(self, job):
        self.jobs.append(job)

    def stop(self, *_, **__):
        pass


@pytest.fixture
def engine(monkeypatch, tmp_path):
    monkeypatch.setattr("flowtree.studio.engine.Worker", Idle)
    told = []
    made = Engine(tmp_path, tmp_path, told.append)
    made.told = told
    return made


def test_what_ends_just_as_it_is_stopped_is_told_as_stopped(engine):
    engine.variants([1, 2, 3])
    (job,) = engine._grower.jobs
    engine.cancel()
    engine._hear(Message(job.number, "done", 0.1))
    assert [event["event"] for event in engine.told] == ["cancelled"]
    assert len(engine._grower.jobs) == 1, "the other variants do not come"
    assert not engine.busy


def test_no_tree_follows_mattes_that_were_stopped(engine):
    engine._submit("matte", engine._cutter)
    engine.cancel()
    engine._hear(Message(engine._cutter.jobs[0].number, "done", 0.1))
    assert engine._grower.jobs == []
    assert [event["event"] for event in engine.told] == ["cancelled"]


def test_what_begins_after_a_stop_goes_on_to_its_end(engine):
    engine.cancel()
    engine._submit("matte", engine._cutter)
    engine._hear(Message(engine._cutter.jobs[0].number, "done", 0.1))
    (tree,) = engine._grower.jobs
    engine._hear(Message(tree.number, "done", 0.2))
    assert [event["event"] for event in engine.told] == ["done", "done"]


def test_mattes_come_back_where_those_of_another_state_may_have_come_meanwhile(engine):
    """A change and its undoing, faster than a matte: its layers may be there before the job was dropped."""
    plain = DocumentState(photos=(DrawnPhoto("photos/1/oak.jpg", 40, 30),))
    picked = replace(plain, photos=(replace(plain.photos[0], tree_colors=("#204010",)),))
    engine.update(plain, 1)
    engine._hear(Message(engine._cutter.jobs[0].number, "done", 0.1))
    engine.update(picked, 2)
    engine.update(plain, 3)
    assert [job.state for job in engine._cutter.jobs] == [plain, picked, plain]
