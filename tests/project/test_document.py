"""Documents: commands and their undoing, gestures, and the folder that the command line reads, too."""

from __future__ import annotations

import errno
import json
import os
from collections.abc import Callable
from dataclasses import replace

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from flowtree.configuration import override_params
from flowtree.errors import FlowtreeError, InputError, OutputError
from flowtree.params import Params
from flowtree.project import commands as do
from flowtree.project.apply_command import apply_command
from flowtree.project.command_json import command_from_json, command_to_json
from flowtree.project.document import Document
from flowtree.project.document_state import DocumentState, DrawnPhoto
from flowtree.project.load_document import load_document
from flowtree.project.load_project import load_project
from flowtree.project.name_command import name_command
from flowtree.project.project import Project
from flowtree.project.save_document import lay_out_project, save_document
from flowtree.project.save_project import save_project
from flowtree.project.state_json import state_from_json, state_to_json
from tests.project.documents import COMMANDS, put_photo, two_photos

_START = DocumentState((DrawnPhoto("photos/0/a.png", 60, 80), DrawnPhoto("photos/1/b.png", 60, 80, 90.0)))
_LINE = ((10.0, 70.0), (20.0, 20.5))


def _do(document: Document, command: do.Command, gesture: str | None = None) -> bool:
    """Does a command that may not fit (there may be no scribble to remove)."""
    try:
        document.apply(command, gesture)
    except InputError:
        return False
    return True


def _problem(work: Callable[[], object]) -> str | None:
    """What the work is refused with; anything but an error of ours is a fault."""
    try:
        work()
    except FlowtreeError as error:
        return str(error)
    return None


@given(st.lists(COMMANDS, max_size=12))
def test_undo_and_redo_go_through_the_same_states(commands):
    document = Document(_START)
    states = [document.state]
    for command in commands:
        if _do(document, command) and document.state != states[-1]:
            states.append(document.state)
    for state in reversed(states[:-1]):
        assert document.undo()
        assert document.state == state
    assert not document.undo()
    for state in states[1:]:
        assert document.redo()
        assert document.state == state
    assert not document.redo()


@given(st.lists(COMMANDS, max_size=8), COMMANDS)
def test_a_refused_command_changes_nothing_and_says_one_line(commands, last):
    document = Document(_START)
    for command in commands:
        _do(document, command)
    before, revision = document.state, document.revision
    problem = _problem(lambda: document.apply(last))
    if problem is not None:
        assert "\n" not in problem
        assert document.state is before
        assert document.revision == revision


@given(COMMANDS)
def test_commands_survive_json(command):
    table = json.loads(json.dumps(command_to_json(command)))
    assert command_from_json(table) == command
    assert name_command(command)


@given(st.lists(COMMANDS, max_size=10))
def test_states_survive_json(commands):
    document = Document(_START)
    for command in commands:
        _do(document, command)
    assert state_from_json(json.loads(json.dumps(state_to_json(document.state)))) == document.state


@settings(max_examples=20, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(commands=st.lists(COMMANDS, max_size=8), back=st.integers(0, 3))
def test_what_is_saved_is_loaded_with_all_that_can_be_undone(tmp_path, commands, back):
    folder = tmp_path / "oak"
    document = two_photos(folder)
    for command in commands:
        _do(document, command)
    for _ in range(back):
        document.undo()
    save_document(document, folder)
    loaded, notice = load_document(folder)
    assert notice is None
    assert loaded.state == document.state
    assert loaded.states() == document.states()
    assert (loaded.position, loaded.steps) == (document.position, document.steps)


def test_a_gesture_is_one_step():
    document = Document(_START)
    for step in range(1, 9):
        document.apply(do.SetParam("flow.step", step / 100), "drag 1")
    document.apply(do.SetParam("flow.step", 0.02), "drag 2")
    document.apply(do.SetParam("flow.pace", 3.0), "drag 2")
    assert len(document.steps) == 3
    document.undo()
    document.undo()
    assert document.state.params.flow.step == 0.08
    document.undo()
    assert document.state == _START


def test_strokes_of_one_gesture_stay_apart():
    document = Document(_START)
    for _ in range(3):
        document.apply(do.AddStroke(0, _LINE), "the same")
    assert len(document.state.photos[0].strokes) == 3
    assert len(document.steps) == 3


def test_the_oldest_steps_fall_away():
    document = Document(_START)
    for seed in range(1, 450):
        document.apply(do.SetSeed(seed))
    assert len(document.steps) == 400
    while document.undo():
        pass
    assert document.state == document.base == replace(_START, seed=49)


def test_new_photos_look_into_the_widest_gap():
    state = DocumentState()
    for number in range(4):
        state = apply_command(do.AddPhoto(f"photos/{number}/a.png", 60, 80), state)
    assert [photo.yaw for photo in state.photos] == [0.0, 90.0, 45.0, 135.0]


def test_the_project_of_a_state_is_the_saved_one(tmp_path):
    folder, scratch = tmp_path / "oak", tmp_path / "scratch"
    document = two_photos(folder)
    for command in (
        do.AddScribble(0, "tree", 3.0, _LINE),
        do.AddStroke(1, _LINE, None, True),
        do.SetMark(1, "top", 4.5),
        do.AddPaint(1, "erase", 9.0, _LINE, 0.2, 0.6),
        do.SetHeight(12.5),
    ):
        document.apply(command)
    save_document(document, folder)
    saved, laid = load_project(folder), lay_out_project(document.state, folder, scratch)
    assert (laid.photos, laid.yaws, laid.height, laid.seed) == (
        saved.photos,
        saved.yaws,
        saved.height,
        saved.seed,
    )
    assert laid.params == saved.params
    for kind in ("strokes", "scribbles", "paint"):
        ours, theirs = getattr(laid, kind), getattr(saved, kind)
        assert {k: (file.name, file.read_bytes()) for k, file in ours.items()} == {
            k: (file.name, file.read_bytes()) for k, file in theirs.items()
        }
        assert ours


def test_photos_stay_as_long_as_they_can_be_undone_to(tmp_path):
    folder = tmp_path / "oak"
    document = two_photos(folder)
    place = document.state.photos[1].place
    document.apply(do.RemovePhoto(1))
    save_document(document, folder)
    assert (folder / place).is_file()
    loaded, _ = load_document(folder)
    loaded.undo()
    assert loaded.state.photos[1].place == place


def test_a_project_of_the_command_line_is_opened_with_its_drawings(tmp_path):
    folder = tmp_path / "oak"
    place = put_photo(folder, "oak.png", 1)
    (tmp_path / "drawn.json").write_text('{"strokes": [[[10, 70], [20, 20]]], "foot": [30, 75]}')
    (tmp_path / "scribbles.json").write_text('{"strokes": [{"label": "tree", "points": [[30, 40]]}]}')
    (tmp_path / "paint.png").write_bytes((folder / place).read_bytes())
    project = Project(
        photos=(folder / place,),
        strokes={0: tmp_path / "drawn.json"},
        scribbles={0: tmp_path / "scribbles.json"},
        paint={0: tmp_path / "paint.png"},
        params=override_params(Params(), ["flow.pace=7"]),
    )
    save_project(project, folder)
    document, notice = load_document(folder)
    assert notice is None
    [photo] = document.state.photos
    assert photo.strokes[0].points == ((10.0, 70.0), (20.0, 20.0))
    assert photo.marks.foot == (30.0, 75.0)
    assert (photo.scribbles[0].label, photo.scribbles[0].width) == ("tree", 8.0)
    assert [kind for kind, _ in photo.attached] == ["paint"]
    with pytest.raises(InputError, match="remove that file first"):
        document.apply(do.AddPaint(0, "add", 4.0, _LINE))
    document.apply(do.RemoveAttached(0, "paint"))
    document.apply(do.AddPaint(0, "add", 4.0, _LINE))
    save_document(document, folder)
    assert load_project(folder).paint[0].name == "oak.paint.json"
    assert load_project(folder).params.flow.pace == 7.0


def test_drawn_svg_becomes_polylines(tmp_path):
    folder = tmp_path / "oak"
    place = put_photo(folder, "oak.png", 1)
    (tmp_path / "drawn.svg").write_text(
        '<svg xmlns="http://www.w3.org/2000/svg"><path d="M10 70 L20 20"/></svg>'
    )
    save_project(Project(photos=(folder / place,), strokes={0: tmp_path / "drawn.svg"}), folder)
    document, _ = load_document(folder)
    assert document.state.photos[0].strokes[0].points[0] == pytest.approx((10.0, 70.0), abs=1e-3)


def test_a_project_changed_elsewhere_counts_and_says_so(tmp_path):
    folder = tmp_path / "oak"
    document = two_photos(folder)
    save_document(document, folder)
    (folder / "params.toml").write_text("[flow]\npace = 3.0\n")
    loaded, notice = load_document(folder)
    assert loaded.state.params.flow.pace == 3.0
    assert loaded.steps == ()
    assert "changed elsewhere" in str(notice)
    # Saved by the command line, the history is gone for good.
    save_project(load_project(folder), folder)
    assert load_document(folder)[1] is None


@pytest.mark.parametrize(
    "damage",
    [
        "{",
        "[]",
        '{"flowtree_history": 9}',
        '{"flowtree_history": 1, "base": {}, "steps": [], "position": 0}',
        '{"flowtree_history": 1, "base": {}, "steps": 3, "position": 0}',
        '{"flowtree_history": 1, "steps": []}',
    ],
)
def test_a_damaged_history_costs_the_undoing_alone(tmp_path, damage):
    folder = tmp_path / "oak"
    document = two_photos(folder)
    save_document(document, folder)
    (folder / "history.json").write_text(damage)
    loaded, notice = load_document(folder)
    assert loaded.state == document.state
    assert "history.json" in str(notice)
    assert "\n" not in str(notice)


def test_a_history_reads_nothing_outside_of_the_folder(tmp_path):
    folder = tmp_path / "oak"
    document = two_photos(folder)
    document.apply(do.RemovePhoto(1))
    save_document(document, folder)
    put_photo(tmp_path, "secret.png", 3)
    text = (folder / "history.json").read_text()
    secret = next(tmp_path.glob("photos/*/secret.png"))
    outside = f"../{secret.relative_to(tmp_path).as_posix()}"
    place = next(state.photos[1].place for state in document.states() if len(state.photos) == 2)
    (folder / "history.json").write_text(text.replace(place, outside))
    loaded, notice = load_document(folder)
    assert "not in the project" in str(notice)
    assert loaded.steps == ()


def test_a_full_disk_leaves_what_was_saved(tmp_path, monkeypatch):
    folder = tmp_path / "oak"
    document = two_photos(folder)
    save_document(document, folder)
    before = {file: file.read_bytes() for file in folder.rglob("*") if file.is_file()}

    def full(*_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "fsync", full)
    document.apply(do.AddScribble(0, "tree", 3.0, _LINE))
    with pytest.raises(OutputError, match="free some space"):
        save_document(document, folder)
    assert {file: file.read_bytes() for file in folder.rglob("*") if file.is_file()} == before


@pytest.mark.parametrize(
    ("command", "message"),
    [
        (do.SetYaw(5, 0.0), "photo: must be one of 2, counted from 0, but got 5"),
        (do.SetYaw(0, float("nan")), "yaw: must be"),
        (do.SetMark(0, "seeds", ()), "mark: must be one of"),
        (do.SetMark(0, "foot", 3.0), "foot: must be a place"),
        (do.SetMark(0, "top", (3.0, 4.0)), "top: must be a number"),
        (do.PlacePhoto(0, (30.0, 10.0), 40.0), "must lie below"),
        (do.SetSeeds(0, ((300.0, 10.0),)), "must lie in the photo"),
        (do.AddScribble(0, "sky", 3.0, _LINE), "needs a label"),
        (do.AddScribble(0, "tree", 0.0, _LINE), "needs a width"),
        (do.AddScribble(0, "tree", 3.0, ()), "needs 1 different points"),
        (do.AddScribble(0, "tree", 3.0, ((-9.0, -9.0),)), "needs a point in the photo"),
        (do.AddStroke(0, ((5.0, 5.0), (5.0, 5.0))), "needs 2 different points"),
        (do.AddStroke(0, ((5.0, float("inf")), (5.0, 5.0))), "near the photo"),
        (do.AddPaint(0, "blur", 3.0, _LINE), "needs a kind"),
        (do.AddPaint(0, "add", 3.0, _LINE, 0.5, 2.0), "strength: must be"),
        (do.RemoveScribbles(0, (0,)), "below 0"),
        (do.RemoveAttached(0, "mattes"), "must lie beside the photo"),
        (do.SetHeight(0.0), "height: must be"),
        (do.SetSeed(-1), "seed: must be"),
        (do.SetParam("flow.stepp", 1.0), "flow.step"),
        (do.SetParam("step", 1.0), "must be a parameter"),
        (do.SetParam("meshing.bark", "/etc/passwd"), "given as a picture"),
        (do.ResetParams("flows"), "must be one of"),
    ],
)
def test_what_is_wrong_with_a_command_is_one_clear_line(command, message):
    with pytest.raises(InputError, match=message) as caught:
        apply_command(command, _START)
    assert "\n" not in str(caught.value)


_VALUES = st.sampled_from(
    [None, True, 7, -1, 2.5, 1e308, 10**400, "", "tree", [], [1, 2], [[1, 2]], [[1, "x"]], [[]], {}, {"a": 1}]
)


@given(
    command=COMMANDS.map(command_to_json),
    changes=st.dictionaries(
        st.sampled_from(["command", "photo", "points", "width", "value", "name", "indices", "yaw", "odd"]),
        _VALUES,
    ),
)
def test_any_json_is_done_or_refused_in_one_line(command, changes):
    table = json.loads(json.dumps({**command, **changes}))
    assert "\n" not in str(_problem(lambda: apply_command(command_from_json(table), _START)))


def test_a_page_cannot_name_files():
    with pytest.raises(InputError, match="must be a known one"):
        command_from_json({"command": "AddPhoto", "place": "/etc/passwd", "width": 1, "height": 1})
