"""Projects on disk: round trips, whole or not at all, and nothing read from outside."""

from __future__ import annotations

import errno
import json
import os
from dataclasses import fields, replace
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from flowtree.configuration import override_params
from flowtree.errors import InputError, OutputError
from flowtree.params import Params
from flowtree.project.load_project import load_project
from flowtree.project.project import PER_PHOTO, Project
from flowtree.project.save_project import save_project


def _file(folder: Path, name: str, content: bytes) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / name
    file.write_bytes(content)
    return file


def _project(folder: Path) -> Project:
    return Project(
        photos=(_file(folder, "oak.jpg", b"front"), _file(folder / "other", "oak.jpg", b"side")),
        yaws=(0.0, 85.5),
        height=12.25,
        seed=7,
        params=override_params(Params(), ["flow.particle_count=77", "matting.foreground_colors=#00ff00"]),
        strokes={1: _file(folder, "drawn.svg", b"<svg/>")},
        paint={0: _file(folder, "paint.json", b"{}")},
    )


def _content(project: Project) -> dict[str, object]:
    """The project with its files' names and contents instead of their places."""
    table = {field.name: getattr(project, field.name) for field in fields(project)}
    table["photos"] = [(file.name, file.read_bytes()) for file in project.photos]
    for kind in PER_PHOTO:
        table[kind] = {k: (file.name, file.read_bytes()) for k, file in table[kind].items()}
    return table


def _snapshot(folder: Path) -> dict[str, bytes]:
    return {str(file.relative_to(folder)): file.read_bytes() for file in folder.rglob("*") if file.is_file()}


def test_what_is_saved_is_loaded(tmp_path):
    project = _project(tmp_path / "photos")
    save_project(project, tmp_path / "work" / "oak")
    assert _content(load_project(tmp_path / "work" / "oak")) == _content(project)


def test_a_project_needs_nothing_outside_itself(tmp_path):
    project = _project(tmp_path / "photos")
    expected = _content(project)
    save_project(project, tmp_path / "oak")
    (tmp_path / "photos").rename(tmp_path / "gone")
    (tmp_path / "oak").rename(tmp_path / "moved")
    assert _content(load_project(tmp_path / "moved")) == expected


def test_pictures_named_by_parameters_move_in(tmp_path):
    bark = _file(tmp_path, "bark.png", b"bark")
    project = replace(
        _project(tmp_path), params=override_params(Params(), [f'meshing.bark="{bark.as_posix()}"'])
    )
    save_project(project, tmp_path / "oak")
    kept = Path(load_project(tmp_path / "oak").params.meshing.bark)
    assert kept.is_relative_to(tmp_path / "oak")
    assert kept.read_bytes() == b"bark"


def test_saving_again_writes_the_same_and_keeps_what_others_put_there(tmp_path):
    project, folder = _project(tmp_path / "photos"), tmp_path / "oak"
    save_project(project, folder)
    _file(folder, "tree.glb", b"tree")
    before = _snapshot(folder)
    save_project(load_project(folder), folder)
    assert _snapshot(folder) == before


def test_an_update_replaces_photos_and_removes_the_old_copies(tmp_path):
    project, folder = _project(tmp_path / "photos"), tmp_path / "oak"
    save_project(project, folder)
    new = (project.photos[0], _file(tmp_path / "new", "oak.jpg", b"a better side"))
    save_project(replace(project, photos=new), folder)
    kept = [data for name, data in _snapshot(folder).items() if name.startswith("photos")]
    assert sorted(kept) == [b"a better side", b"front"]


def test_a_failure_leaves_the_old_project(tmp_path, monkeypatch):
    project, folder = _project(tmp_path / "photos"), tmp_path / "oak"
    save_project(project, folder)
    before = _snapshot(folder)
    changed = replace(project, seed=8, photos=(project.photos[0], _file(tmp_path / "new", "b.jpg", b"new")))

    def full(*_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OutputError, match="free some space"):
        save_project(changed, folder)
    assert _snapshot(folder) == before
    with pytest.raises(OutputError):
        save_project(changed, tmp_path / "fresh" / "folder")
    assert not (tmp_path / "fresh").exists()


def test_a_file_in_the_way_is_an_output_error(tmp_path):
    project = _project(tmp_path / "photos")
    with pytest.raises(OutputError, match="could not be written"):
        save_project(project, _file(tmp_path, "oak", b""))


def test_a_missing_photo_is_an_input_error(tmp_path):
    with pytest.raises(InputError, match=r"nothing\.jpg"):
        save_project(Project(photos=(tmp_path / "nothing.jpg",)), tmp_path / "oak")
    assert not (tmp_path / "oak").exists()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (None, "must be JSON"),
        ([], "format 1, but got 'list'"),
        ({"flowtree_project": 99}, "format 1, but got 99"),
        ({"photos": 3}, "needs a list of photos"),
        ({"photos": ["../secret.jpg"]}, "inside the project"),
        ({"photos": ["photos/none.jpg"]}, "must be there"),
        ({"photos": [5]}, "must name files"),
        ({"strokes": {"9": "drawn.svg"}}, "count photos from 0 to 1"),
        ({"strokes": []}, "must list files by name"),
        ({"height": "tall"}, "needs a number as height"),
        ({"yaws": 3}, "needs a list of yaws"),
        ({"seed": 1.5}, "whole number as seed"),
    ],
)
def test_a_damaged_project_is_one_clear_line(tmp_path, change, message):
    save_project(_project(tmp_path / "photos"), tmp_path / "oak")
    _file(tmp_path, "secret.jpg", b"secret")
    file = tmp_path / "oak" / "project.json"
    table = json.loads(file.read_text())
    changed = "{" if change is None else json.dumps(table | change if isinstance(change, dict) else change)
    file.write_text(changed)
    with pytest.raises(InputError, match=message) as caught:
        load_project(tmp_path / "oak")
    assert "\n" not in str(caught.value)


def test_parameters_edited_by_hand_are_checked(tmp_path):
    save_project(_project(tmp_path / "photos"), tmp_path / "oak")
    (tmp_path / "oak" / "params.toml").write_text("[flow]\nparticle_count = 0\n")
    with pytest.raises(InputError, match=r"params\.toml: flow\.particle_count: must be at least 1"):
        load_project(tmp_path / "oak")


def test_no_project_is_an_input_error(tmp_path):
    with pytest.raises(InputError, match="name a project's folder"):
        load_project(tmp_path)


_JSON = st.recursive(
    st.none() | st.booleans() | st.integers(-3, 3) | st.text(max_size=4),
    lambda inner: st.lists(inner, max_size=2) | st.dictionaries(st.text(max_size=3), inner, max_size=2),
    max_leaves=4,
)


@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    name=st.sampled_from(["photos", "yaws", "height", "seed", "strokes", "pictures", "flowtree_project"]),
    value=_JSON,
)
def test_any_value_in_the_file_is_taken_or_refused(tmp_path, name, value):
    folder = tmp_path / "oak"
    if not folder.exists():
        save_project(_project(tmp_path / "photos"), folder)
        (folder / "good.json").write_bytes((folder / "project.json").read_bytes())
    table = json.loads((folder / "good.json").read_text()) | {name: value}
    (folder / "project.json").write_text(json.dumps(table))
    try:
        loaded = load_project(folder)
    except InputError:
        return
    assert len(loaded.photos) == 2
