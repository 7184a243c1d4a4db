"""``flowtree reconstruct``: outputs, projects, and one line for whatever is wrong with the input."""

from __future__ import annotations

import errno
import json
import os
import struct
import zlib
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from flowtree.export.inspect_file import inspect_file
from tests.pictures import draw_tree, save_pair

SMALL = (
    *("--set", "density.resolution=20", "--set", "flow.particle_count=150"),
    *("--set", "attraction.grid_height=64", "--set", "attraction.seed_count=8", "--set", "render.size=64"),
)


def _errors(outcome) -> list[str]:
    """What stands on stderr besides progress."""
    return [line for line in outcome.err.splitlines() if "%" not in line[:4]]


def _assert_refused(outcome, *words: str) -> None:
    assert outcome.code == 1, outcome
    errors = _errors(outcome)
    assert len(errors) == 1, errors
    assert errors[0].startswith("flowtree: ")
    assert "unexpected" not in errors[0]
    for word in words:
        assert word in errors[0]


def test_writes_everything_that_is_asked_for(flowtree, tmp_path):
    front, side = save_pair(tmp_path)
    done = flowtree(
        *("reconstruct", front, side, "-o", "tree.glb", "--height", 6, "--yaw", "0,80", *SMALL),
        *("--skeleton", "tree.swc", "--preview", "tree.png", "--report", "tree.json"),
        *("--levels", 2, "--max-triangles", 4000, "--quantise", "--sway", "--collision", "godot"),
    )
    assert done.code == 0, done.err
    assert done.out.startswith("tree.glb: ")
    report, found = json.loads((tmp_path / "tree.json").read_text()), inspect_file(tmp_path / "tree.glb")
    assert report["views"][1]["yaw"] == 80.0
    levels = [level["triangles"] for level in report["asset"]["levels"]]
    assert levels == [level["triangles"] for level in found["levels"]]
    assert 4000 >= levels[0] > levels[1]
    assert found["skins"]
    assert found["bodies"]
    assert found["extensions"]["required"] == ["KHR_mesh_quantization"]
    with Image.open(tmp_path / "tree.png") as picture:
        assert picture.width == 133
        assert picture.height > 64
    assert (tmp_path / "tree.swc").stat().st_size > 1000


def test_a_project_makes_the_same_tree_again(flowtree, tmp_path):
    front, side = save_pair(tmp_path)
    stroke = {"strokes": [{"points": [[80, 180], [120, 60]]}]}
    (tmp_path / "drawn.json").write_text(json.dumps(stroke))
    first = flowtree(
        *("reconstruct", front, side, "-o", "first.glb", "--height", 6, "--seed", 5, *SMALL),
        *("--strokes", "1=drawn.json", "--project", "oak"),
    )
    assert first.code == 0, first.err
    for file in (front, side, tmp_path / "drawn.json"):
        file.unlink()
    again = flowtree("reconstruct", "--project", "oak", "-o", "again.glb")
    assert again.code == 0, again.err
    assert (tmp_path / "first.glb").read_bytes() == (tmp_path / "again.glb").read_bytes()
    other = flowtree("reconstruct", "--project", "oak", "-o", "other.glb", "--seed", 6)
    assert other.code == 0
    assert (tmp_path / "first.glb").read_bytes() != (tmp_path / "other.glb").read_bytes()


def test_what_was_pointed_at_reaches_the_tree_and_the_project(flowtree, tmp_path):
    front, side = save_pair(tmp_path)
    (tmp_path / "marks.json").write_text('{"foot": [82, 190], "top": 10, "fork": [80, 150]}')
    first = flowtree(
        *("reconstruct", front, side, "-o", "first.glb", "--height", 6, *SMALL, "--report", "first.json"),
        *("--strokes", "marks.json", "--project", "oak"),
    )
    assert first.code == 0, first.err
    view = json.loads((tmp_path / "first.json").read_text())["views"][0]["matte"]
    assert view["foot_pixel"] == [82.0, 190.0]
    assert view["metres_per_pixel"] == 6.0 / 180.0
    for file in (front, side, tmp_path / "marks.json"):
        file.unlink()
    again = flowtree("reconstruct", "--project", "oak", "-o", "again.glb")
    assert again.code == 0, again.err
    assert (tmp_path / "first.glb").read_bytes() == (tmp_path / "again.glb").read_bytes()


def test_ctrl_c_leaves_what_was_there(flowtree, tmp_path, monkeypatch):
    def interrupt(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr("flowtree.export.export_tree.export_tree", interrupt)
    front, side = save_pair(tmp_path)
    (tmp_path / "tree.glb").write_bytes(b"old")
    done = flowtree("reconstruct", front, side, "-o", "tree.glb", *SMALL)
    assert done.code == 130
    assert (tmp_path / "tree.glb").read_bytes() == b"old"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["front.png", "side.png", "tree.glb"]


def _png_that_claims(width: int, height: int) -> bytes:
    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", header)
        + chunk(b"IDAT", zlib.compress(b""))
        + chunk(b"IEND", b"")
    )


def _flat(path: Path, color: tuple[int, ...], size: tuple[int, int] = (120, 160)) -> None:
    Image.new("RGB" if len(color) == 3 else "RGBA", size, color).save(path)


def _make_bad_photo(kind: str, path: Path) -> None:
    match kind:
        case "not an image":
            path.write_text("a letter about a tree")
        case "empty file":
            path.write_bytes(b"")
        case "truncated":
            Image.fromarray(draw_tree(0)).save(path)
            path.write_bytes(path.read_bytes()[:900])
        case "1 x 1":
            _flat(path, (10, 20, 30), (1, 1))
        case "60,000 x 60,000 claimed":
            path.write_bytes(_png_that_claims(60_000, 60_000))
        case "all sky":
            _flat(path, (150, 190, 240))
        case "empty alpha":
            _flat(path, (30, 90, 30, 0))
        case "a folder":
            path.mkdir()
        case "missing":
            pass


@pytest.mark.parametrize(
    "kind",
    [
        *("not an image", "empty file", "truncated", "1 x 1", "60,000 x 60,000 claimed", "all sky"),
        *("empty alpha", "a folder", "missing"),
    ],
)
def test_a_bad_photo_is_one_line_with_its_name(flowtree, tmp_path, kind):
    _, side = save_pair(tmp_path)
    _make_bad_photo(kind, tmp_path / "bad.png")
    done = flowtree("reconstruct", side, "bad.png", *SMALL)
    _assert_refused(done, "bad.png")
    assert not (tmp_path / "tree.glb").exists()


def test_a_picture_that_is_all_tree_is_made_or_refused(flowtree, tmp_path):
    _, side = save_pair(tmp_path)
    rng = np.random.default_rng(0)
    Image.fromarray(rng.integers(20, 90, (160, 120, 3), dtype=np.uint8)).save(tmp_path / "leaves.png")
    done = flowtree("reconstruct", side, "leaves.png", *SMALL)
    if done.code:
        _assert_refused(done, "leaves.png")


def test_a_full_disk_leaves_the_old_tree(flowtree, tmp_path, monkeypatch):
    def full(*_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    front, side = save_pair(tmp_path)
    (tmp_path / "tree.glb").write_bytes(b"old")
    monkeypatch.setattr(os, "fsync", full)
    _assert_refused(
        flowtree("reconstruct", front, side, *SMALL), "tree.glb", "No space left", "free some space"
    )
    assert (tmp_path / "tree.glb").read_bytes() == b"old"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["front.png", "side.png", "tree.glb"]


@pytest.mark.parametrize(
    ("option", "name", "content"),
    [
        ("--strokes", "bad.svg", "<svg><path d='M 0 0 L"),
        ("--strokes", "bad.json", "{"),
        ("--strokes", "outside.json", '{"strokes": [{"points": [[-900, -900], [-800, -800]]}]}'),
        ("--strokes", "neither.json", "{}"),
        ("--strokes", "foot.json", '{"foot": [80, 900]}'),
        ("--strokes", "foot.json", '{"foot": "below"}'),
        ("--strokes", "top.json", '{"top": 190, "foot": [80, 20]}'),
        ("--strokes", "seeds.json", '{"seeds": [[1, 2], [3]]}'),
        ("--strokes", "name.json", '{"forks": [80, 100], "top": 9}'),
        ("--strokes", "strokes.txt", "M 0 0"),
        ("--strokes", "missing.svg", None),
        ("--scribbles", "bad.json", '{"strokes": 7}'),
        ("--trimap", "bad.png", "no picture"),
        ("--paint", "bad.json", '{"layers": [{"kind": "burn"}]}'),
        ("--params", "bad.toml", "[flow\n"),
        ("--params", "unknown.toml", "[flow]\nparticle_cuont = 3\n"),
        ("--params", "missing.toml", None),
    ],
)
def test_a_bad_file_is_one_line_with_its_name(flowtree, tmp_path, option, name, content):
    front, side = save_pair(tmp_path)
    if content is not None:
        (tmp_path / name).write_text(content)
    _assert_refused(flowtree("reconstruct", front, side, option, name, *SMALL), name)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--yaw", "0,0"), ("yaw", "0 and 0")),
        (("--yaw", "0,360"), ("yaw",)),
        (("--yaw", "0,180"), ("yaw",)),
        (("--yaw", "0"), ("yaw", "once a photo")),
        (("--yaw", "front,side"), ("--yaw", "0,90")),
        (("--height", "-3"), ("height",)),
        (("--height", "nan"), ("height",)),
        (("--seed", "-1"), ("seed",)),
        (("--set", "flow.particle_cuont=3"), ("did you mean 'flow.particle_count'?",)),
        (("--set", "flow.particle_count=0"), ("at least 1",)),
        (("--set", "nothing"), ("NAME=VALUE",)),
        (("--strokes", "7=a.svg"), ("--strokes", "photo")),
        (("--strokes", "0=a.svg", "--strokes", "0=b.svg"), ("--strokes", "once a photo")),
        (("-o", "tree.docx"), ("--output", ".glb")),
        (("-o", "missing/tree.glb"), ("missing",)),
        (("-o", "front.png/tree.glb"), ("front.png",)),
        (("--preview", "tree.gif"), ("--preview", ".png")),
        (("--report", "report.txt"), ("--report", ".json")),
        (("--skeleton", "tree.glb"), ("--skeleton", ".swc")),
        (("-o", "tree.ply", "--skeleton", "tree.ply"), ("differ",)),
        (("--project", "front.png"), ("front.png",)),
    ],
)
def test_a_wrong_option_is_one_line(flowtree, tmp_path, arguments, words):
    front, side = save_pair(tmp_path)
    before = sorted(path.name for path in tmp_path.iterdir())
    _assert_refused(flowtree("reconstruct", front, side, *SMALL, *arguments), *words)
    left = {path.name for path in tmp_path.iterdir()} - {"tree.glb"}
    assert sorted(left) == before


def test_no_project_there_is_one_line(flowtree, tmp_path):
    _assert_refused(flowtree("reconstruct", "--project", "nowhere"), "project.json")
