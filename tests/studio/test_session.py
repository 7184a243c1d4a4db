"""A session: what it makes is what the command line makes, and nothing of a project is ever lost."""

from __future__ import annotations

import errno
import io
import json
import os
import signal
import zipfile

import pytest

from flowtree.cli.main import app
from flowtree.errors import FlowtreeError, InputError, OutputError
from flowtree.project import commands as do
from flowtree.project.load_document import load_document
from flowtree.studio.session import Session
from tests.studio.sessions import Ear, small_session

_LINE = ((80.0, 180.0), (85.0, 120.0), (60.0, 70.0))


@pytest.fixture(scope="module")
def studio(tmp_path_factory):
    with small_session(tmp_path_factory.mktemp("studio") / "oak") as (session, ear):
        ear.end("tree")
        yield session, ear


def test_the_first_tree_comes_by_itself_coarse_before_fine(studio):
    session, ear = studio
    shown = [event["name"] for event in ear.events if event["event"] == "layer"]
    wanted = ["photo/0", "matte/0", "cameras", "voxels", "graph/0", "field", "flow", "skeleton", "coarse.glb"]
    wanted += ["tree.glb", "report"]
    places = [shown.index(name) for name in wanted]
    assert shown.index("photo/0") < shown.index("matte/0") < shown.index("voxels") < shown.index("flow")
    assert shown.index("flow") < shown.index("coarse.glb") < shown.index("tree.glb") < shown.index("report")
    assert len(places) == len(wanted)
    assert set(wanted) <= set(session.layers())
    report = json.loads(session.layer("report").data)
    assert len(report["views"]) == 2


def test_the_command_line_makes_the_same_bytes(studio, tmp_path):
    session, ear = studio
    since = len(ear.events)
    session.apply(do.AddStroke(0, _LINE))
    session.apply(do.SetMark(1, "top", 3.0))
    session.apply(do.AddPaint(1, "add", 30.0, ((120.0, 60.0), (130.0, 70.0)), 0.2, 0.9))
    session.apply(do.AddScribble(0, "occluder", 6.0, ((20.0, 190.0),)))
    session.apply(do.SetParam("leaves.size", 0.03))
    session.apply(do.SetSeed(3))
    ear.end("tree", since)
    export = session.export("glb", {})
    event = ear.word("exported", since)
    assert event["id"] == export
    name, ours = session.exported(export)
    session.flush()
    output = tmp_path / "tree.glb"
    app(["reconstruct", "--project", str(session.folder), "-o", str(output)], standalone_mode=False)
    assert output.read_bytes() == ours
    assert name == "oak.glb"


def test_an_export_takes_options_and_leaves_the_project_alone(studio):
    session, ear = studio
    before, since = session.state_json()["params"], len(ear.events)
    export = session.export("obj", {"asset.max_triangles": 3000})
    event = ear.word("exported", since)
    name, data = session.exported(export)
    assert name.endswith(".zip")
    assert set(zipfile.ZipFile(io.BytesIO(data)).namelist()) == set(event["files"]) > {"oak.obj"}
    assert session.state_json()["params"] == before
    since = len(ear.events)
    export = session.export("swc", {})
    ear.word("exported", since)
    assert session.exported(export)[0] == "oak.swc"


@pytest.mark.parametrize(
    ("kind", "options", "message"),
    [
        ("exe", {}, "must be of a known kind"),
        ("glb", {"flow.step": 0.1}, "takes options of"),
        ("glb", {"meshing.bark": "/etc/passwd"}, "takes options of"),
        ("glb", {"asset.levels": 99}, "must be at most"),
        ("glb", {"asset.level": 1}, "asset.level"),
    ],
)
def test_a_wrong_export_is_one_clear_line(studio, kind, options, message):
    with pytest.raises(InputError, match=message):
        studio[0].export(kind, options)


def test_what_an_edit_does_not_touch_is_not_sent_again(studio):
    session, ear = studio
    since = len(ear.events)
    session.apply(do.SetParam("leaves.amount", 0.7))
    ear.end("tree", since)
    sent = {event["name"] for event in ear.events[since:] if event["event"] == "layer"}
    assert sent == {"tree.glb", "report"}


def test_a_scribble_sends_the_box_that_changed(studio):
    session, ear = studio
    session.apply(do.AddScribble(1, "occluder", 20.0, ((80.0, 100.0),)))
    event = ear.wait(lambda event: event.get("name") == "matte/1" and "box" in event)
    left, top, right, bottom = event["box"]
    assert 0 <= left < right <= 160
    assert 0 <= top < bottom <= 200
    assert session.layer("matte-part/1").data[:4] == b"\x89PNG"


def test_newer_states_supersede_older_ones(studio):
    session, ear = studio
    since = len(ear.events)
    for amount in range(1, 10):
        session.apply(do.SetParam("leaves.amount", amount / 10), "one drag")
    ear.end("tree", since)
    done = [event for event in ear.events[since:] if event["event"] == "done" and event["job"] == "tree"]
    assert len(done) == 1
    assert session.undo()
    assert session.state_json()["params"]["leaves"]["amount"] == 0.7


def test_undo_brings_a_removed_photo_back_with_its_layers(studio):
    session, ear = studio
    since = len(ear.events)
    session.apply(do.RemovePhoto(1))
    assert "matte/1" not in session.layers()
    assert {event["name"] for event in ear.events[since:] if event["event"] == "removed"} >= {
        "photo/1",
        "matte/1",
    }
    session.undo()
    assert "matte/1" in session.layers()
    ear.end("tree", since)


def test_variants_come_one_by_one_and_the_chosen_one_is_there_already(studio):
    session, ear = studio
    ear.wait(lambda event: not session.busy)
    since = len(ear.events)
    session.variants([11, 12])
    ear.end("variants", since)
    assert session.layer("variant/11").data != session.layer("variant/12").data
    with pytest.raises(InputError, match="1 to 12 whole numbers"):
        session.variants([])


def test_an_edit_does_not_end_the_variants_that_are_awaited(studio):
    session, ear = studio
    since = len(ear.events)
    session.variants((41, 42, 43))
    ear.wait(lambda event: event.get("name") == "variant/41", since)
    session.apply(do.SetSeed(41))
    for seed in (42, 43):
        ear.wait(lambda event, seed=seed: event.get("name") == f"variant/{seed}", since)
    ear.end("variants", since)
    told = [event["name"] for event in ear.events[since:] if event.get("name", "").startswith("variant/")]
    assert told == ["variant/41", "variant/42", "variant/43"]
    session.variants((51, 52))
    session.cancel()
    ear.word("cancelled", since)
    since = len(ear.events)
    session.apply(do.SetSeed(0))
    ear.end("tree", since)
    assert not session.busy, "what was cancelled is not made by the next edit"


def test_cancelling_ends_what_runs_and_the_next_change_goes_on(studio):
    session, ear = studio
    since = len(ear.events)
    session.apply(do.SetSeed(21))
    ear.wait(lambda event: event["event"] == "progress" and event["job"] == "tree", since)
    session.cancel()
    ear.word("cancelled", since)
    assert not session.busy
    since = len(ear.events)
    session.apply(do.SetSeed(22))
    ear.end("tree", since)


def test_a_crashed_worker_is_told_and_the_next_change_goes_on(studio):
    session, ear = studio
    since = len(ear.events)
    session.apply(do.SetSeed(31))
    ear.wait(lambda event: event["event"] == "progress" and event["job"] == "tree", since)
    os.kill(session.pids[1], signal.SIGKILL)
    event = ear.wait(lambda event: event["event"] in ("failed", "done") and event["job"] == "tree", since)
    if event["event"] == "failed":  # else it was quicker than the signal
        assert "ended unexpectedly" in event["message"]
        assert session.state_json()["problem"] == event["message"]
    since = len(ear.events)
    session.apply(do.SetSeed(32))
    ear.end("tree", since)
    assert session.state_json()["problem"] is None


def test_a_fault_of_the_input_is_told_in_its_words(studio):
    session, ear = studio
    since = len(ear.events)
    session.apply(do.SetYaw(1, 180.0))
    event = ear.wait(lambda event: event["event"] == "failed", since)
    assert "must not all be from one side" in event["message"]
    since = len(ear.events)
    session.undo()
    ear.end("tree", since)


def test_a_full_disk_is_told_and_saving_goes_on_later(studio, monkeypatch):
    session, ear = studio
    session.flush()

    def full(*_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    since = len(ear.events)
    with monkeypatch.context() as patch:
        patch.setattr(os, "fsync", full)
        session.apply(do.SetHeight(7.5))
        assert "free some space" in ear.word("unsaved", since)["message"]
        assert not session.state_json()["saved"]
        with pytest.raises(OutputError):
            session.add_photo("more.png", session.layer("matte/0").data)
    since = len(ear.events)
    session.apply(do.SetHeight(8.5))
    ear.word("saved", since)
    assert session.state_json()["saved"]
    assert load_document(session.folder)[0].state.height == 8.5


def test_a_command_that_is_refused_changes_nothing(studio):
    session, _ = studio
    before = session.state_json()
    for table in (3, {}, {"command": "SetYaw"}, {"command": "SetYaw", "photo": 9, "yaw": 1}, {"gesture": 1}):
        with pytest.raises(InputError):
            session.apply_json(table)
    with pytest.raises(InputError, match="must be a whole"):
        session.add_photo("photo.jpg", b"\xff\xd8 no picture")
    with pytest.raises(InputError, match="must end in"):
        session.add_photo("photo.exe", b"MZ")
    after = session.state_json()
    assert after["revision"] == before["revision"]
    assert not list(session.folder.glob("photos/*/photo.jpg"))


def test_a_project_is_open_once_and_tabs_know_of_each_other(studio):
    session, _ = studio
    with pytest.raises(InputError, match="one studio at a time"):
        Session.open(session.folder)
    assert session.enter() == 0
    assert session.enter() == 1
    session.leave()
    session.leave()


def test_all_is_there_when_it_is_opened_again(tmp_path):
    with small_session(tmp_path / "oak") as (session, ear):
        session.apply_json({"command": "AddStroke", "photo": 0, "points": [[80, 180], [70, 90]]})
        before = session.state_json()
    session = Session.open(tmp_path / "oak")
    try:
        ear = Ear(session)
        after = session.state_json()
        for name in ("photos", "params", "height", "seed", "undo", "redo"):
            assert after[name] == before[name]
        assert session.undo()
        assert session.redo()
        ear.end("tree")
        # As an archive it can be put in the place of another project, and taken back.
        session.export("project", {})
        _, packed = session.exported(ear.word("exported")["id"])
    finally:
        session.close()
    other = Session.open(tmp_path / "other")
    try:
        other.open_archive(packed)
        taken = other.state_json()
        assert [photo["strokes"] for photo in taken["photos"]] == [p["strokes"] for p in before["photos"]]
        assert taken["undo"] == "Open project"
        other.flush()
        assert load_document(tmp_path / "other")[1] is None
        other.undo()
        assert other.state_json()["photos"] == []
    finally:
        other.close()


def test_a_damaged_project_is_refused_and_can_be_opened_later(tmp_path):
    (tmp_path / "project.json").write_text("{")
    with pytest.raises(FlowtreeError, match="must be JSON"):
        Session.open(tmp_path)
    (tmp_path / "project.json").unlink()
    Session.open(tmp_path).close()
