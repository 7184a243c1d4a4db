"""Archives from anywhere: what is no project is refused before anything is unpacked."""

from __future__ import annotations

import io
import json
import zipfile

import pytest

from flowtree.errors import InputError
from flowtree.project import commands as do
from flowtree.project.save_document import save_document
from flowtree.studio import read_archive as module
from flowtree.studio.read_archive import read_archive
from tests.project.documents import two_photos


def _packed(files, links=()):
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in files.items():
            archive.writestr(name, data)
        for name in links:
            entry = zipfile.ZipInfo(name)
            entry.external_attr = 0o120777 << 16
            archive.writestr(entry, "/etc/passwd")
    return content.getvalue()


@pytest.fixture
def project(tmp_path):
    folder = tmp_path / "oak"
    document = two_photos(folder)
    document.apply(do.AddScribble(0, "tree", 4.0, ((30.0, 30.0),)))
    save_document(document, folder)
    files = [file for file in folder.rglob("*") if file.is_file()]
    return document, {file.relative_to(folder).as_posix(): file.read_bytes() for file in files}


def test_a_project_comes_over_with_its_photos(tmp_path, project):
    document, files = project
    target = tmp_path / "target"
    target.mkdir()
    state = read_archive(_packed(files), target)
    assert state == document.state
    assert all((target / photo.place).is_file() for photo in state.photos)
    assert not (target / "project.json").exists()


@pytest.mark.parametrize(
    "name", ["../evil.py", "/etc/evil", "photos/../../evil", "C:\\evil", "photos\\evil", "c:/evil"]
)
def test_no_name_leads_out_of_the_folder(tmp_path, project, name):
    target = tmp_path / "deep" / "target"
    target.mkdir(parents=True)
    with pytest.raises(InputError, match="plain files in folders"):
        read_archive(_packed({**project[1], name: b"evil"}), target)
    assert list(target.iterdir()) == []


def test_links_are_refused(tmp_path, project):
    with pytest.raises(InputError, match="plain files in folders"):
        read_archive(_packed(project[1], links=["photos/0123456789ab/oak.png"]), tmp_path)


def test_what_no_project_holds_is_left_packed(tmp_path, project):
    target = tmp_path / "target"
    target.mkdir()
    read_archive(_packed({**project[1], "run.sh": b"evil", "photos/evil.sh": b"evil"}), target)
    assert not [file for file in target.rglob("*") if file.is_file() and file.suffix == ".sh"]


def test_bombs_are_refused_by_what_they_say_and_by_what_they_are(tmp_path, project, monkeypatch):
    monkeypatch.setattr(module, "_MOST_BYTES", 100_000)
    with pytest.raises(InputError, match="must unpack to under"):
        read_archive(_packed({**project[1], "photos/0123456789ab/a.png": b"0" * 200_000}), tmp_path)
    many = {f"photos/{k}/a.png": b"" for k in range(600)}
    with pytest.raises(InputError, match="at most 500 files"):
        read_archive(_packed({**project[1], **many}), tmp_path)
    packed = bytearray(_packed({**project[1], "photos/0123456789ab/a.png": b"0" * 50_000}))
    # The central directory tells a smaller size than the data has.
    at = packed.rindex(b"photos/0123456789ab/a.png") - 46 + 24
    packed[at : at + 4] = (10).to_bytes(4, "little")
    with pytest.raises(InputError, match="archive: must"):
        read_archive(bytes(packed), tmp_path)


@pytest.mark.parametrize("data", [b"", b"PK\x05\x06 no", b"\x89PNG"])
def test_no_archive_is_one_clear_line(tmp_path, data):
    with pytest.raises(InputError, match="must be a zip file") as caught:
        read_archive(data, tmp_path)
    assert "\n" not in str(caught.value)


def test_an_archive_without_a_project_is_refused(tmp_path, project):
    with pytest.raises(InputError, match="must hold a project"):
        read_archive(_packed({"readme.txt": b""}), tmp_path)
    table = json.loads(project[1]["project.json"]) | {"photos": ["../secret.png"]}
    with pytest.raises(InputError, match="inside the project"):
        read_archive(_packed({**project[1], "project.json": json.dumps(table).encode()}), tmp_path)
