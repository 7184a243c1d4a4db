"""Files are replaced whole or not at all."""

from __future__ import annotations

import errno
import os
import stat
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from flowtree.errors import FlowtreeError, OutputError
from flowtree.files import write_all_whole, write_whole


def fail_with(number: int):
    def failing(*_: object, **__: object) -> None:
        raise OSError(number, os.strerror(number))

    return failing


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(old=st.none() | st.binary(max_size=50), new=st.binary(max_size=50))
def test_the_file_holds_the_bytes_whatever_stood_there(tmp_path: Path, old: bytes | None, new: bytes) -> None:
    path = tmp_path / "tree.glb"
    path.unlink(missing_ok=True)
    if old is not None:
        path.write_bytes(old)
    write_whole(path, new)
    assert path.read_bytes() == new
    assert names(tmp_path) == ["tree.glb"]


def test_a_new_file_has_usual_permissions_and_an_old_one_keeps_its_own(tmp_path: Path) -> None:
    usual, path = tmp_path / "usual", tmp_path / "tree.glb"
    usual.write_bytes(b"")
    write_whole(path, b"a")
    assert path.stat().st_mode == usual.stat().st_mode
    path.chmod(0o640)
    write_whole(path, b"b")
    assert stat.S_IMODE(path.stat().st_mode) == 0o640


def test_a_link_stays_a_link(tmp_path: Path) -> None:
    real, link = tmp_path / "real.glb", tmp_path / "link.glb"
    real.write_bytes(b"old")
    link.symlink_to(real)
    write_whole(link, b"new")
    assert link.is_symlink()
    assert real.read_bytes() == b"new"


@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EDQUOT, errno.EIO])
@pytest.mark.parametrize("step", ["fsync", "replace"])
def test_a_failure_leaves_the_old_file_and_nothing_else(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, number: int, step: str
) -> None:
    path = tmp_path / "tree.glb"
    path.write_bytes(b"old")
    monkeypatch.setattr(os, step, fail_with(number))
    with pytest.raises(OutputError) as caught:
        write_whole(path, b"new")
    assert "tree.glb: could not be written" in str(caught.value)
    assert "\n" not in str(caught.value)
    assert isinstance(caught.value, (FlowtreeError, OSError))
    assert path.read_bytes() == b"old"
    assert names(tmp_path) == ["tree.glb"]


def test_a_full_disk_says_so_and_what_to_do() -> None:
    full = Path("/dev/full")
    if not full.exists():
        pytest.skip("this system has no /dev/full")
    with pytest.raises(
        OutputError, match=r"/dev/full: could not be written: No space left.*; free some space"
    ):
        write_whole(full, b"new")
    assert stat.S_ISCHR(full.stat().st_mode)


@pytest.mark.parametrize(
    ("name", "remedy"),
    [
        ("missing/tree.glb", "make that folder first"),
        ("file/tree.glb", "name a folder, not a file"),
        ("folder", "name a file, not a folder"),
        ("x" * 300, "choose a shorter name"),
        ("nul\0.glb", "choose another place"),
    ],
)
def test_an_impossible_place_gets_one_clear_line(tmp_path: Path, name: str, remedy: str) -> None:
    (tmp_path / "folder").mkdir()
    (tmp_path / "file").write_bytes(b"old")
    with pytest.raises(OutputError, match=remedy) as caught:
        write_whole(tmp_path / name, b"new")
    assert "\n" not in str(caught.value)
    assert names(tmp_path) == ["file", "folder"]
    assert (tmp_path / "file").read_bytes() == b"old"


def test_a_protected_file_and_a_protected_folder_are_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "tree.glb"
    path.write_bytes(b"old")
    # Who runs the tests may be allowed everything (root), so the system's answers are put in its mouth.
    with monkeypatch.context() as patch:
        patch.setattr(os, "access", lambda *_: False)
        with pytest.raises(OutputError, match="change the permissions"):
            write_whole(path, b"new")
    monkeypatch.setattr(Path, "open", fail_with(errno.EACCES))
    with pytest.raises(OutputError, match="change the permissions"):
        write_whole(path, b"new")
    monkeypatch.undo()
    assert path.read_bytes() == b"old"
    assert names(tmp_path) == ["tree.glb"]


@pytest.mark.parametrize("failing_call", [1, 2, 3])
@pytest.mark.parametrize("links", [True, False])
def test_several_files_are_all_replaced_or_none(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, failing_call: int, links: bool
) -> None:
    first, fresh, last = (tmp_path / name for name in ("a.png", "b.mtl", "c.obj"))
    first.write_bytes(b"old a")
    last.write_bytes(b"old c")
    replace, calls = os.replace, 0

    def sometimes(source: object, target: object) -> None:
        nonlocal calls
        calls += 1
        if calls == failing_call:
            raise OSError(errno.EIO, os.strerror(errno.EIO))
        replace(source, target)  # type: ignore[arg-type]

    contents = {first: b"new a", fresh: b"new b", last: b"new c"}
    if not links:
        monkeypatch.setattr(os, "link", fail_with(errno.EPERM))
    with monkeypatch.context() as patch:
        patch.setattr(os, "replace", sometimes)
        with pytest.raises(OutputError):
            write_all_whole(contents)
    assert names(tmp_path) == ["a.png", "c.obj"]
    assert (first.read_bytes(), last.read_bytes()) == (b"old a", b"old c")
    write_all_whole(contents)
    assert {path: path.read_bytes() for path in contents} == contents
    assert names(tmp_path) == ["a.png", "b.mtl", "c.obj"]
