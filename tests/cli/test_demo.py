"""``flowtree demo``: the first thing a newcomer runs."""

from __future__ import annotations

import json
from pathlib import Path

from PIL import Image

import flowtree.cli.demo
from flowtree.export.inspect_file import inspect_file


def test_the_demo_makes_a_good_tree_and_says_where(flowtree, tmp_path):
    done = flowtree("demo", "-o", "results/demo")
    assert done.code == 0, done.err
    folder = tmp_path / "results" / "demo"
    assert sorted(file.name for file in folder.iterdir()) == ["preview.png", "report.json", "tree.glb"]
    for file in folder.iterdir():
        assert str(Path("results", "demo", file.name)) in done.out
    report = json.loads((folder / "report.json").read_text())
    assert report["warnings"] == []
    assert min(view["soft_iou"] for view in report["views"]) > 0.7
    assert report["mesh"]["watertight"]
    assert report["leaves"] > 1000
    with Image.open(folder / "preview.png") as sheet:
        assert sheet.width == 1600
        assert 1000 < sheet.height < 2000
    found = inspect_file(folder / "tree.glb")
    assert found["triangles"] == report["asset"]["levels"][0]["triangles"] <= 50_000
    assert found["bytes"] == report["asset"]["files"]["tree.glb"]


def test_the_demo_refuses_a_file_as_its_folder(flowtree, tmp_path):
    (tmp_path / "taken").write_text("")
    done = flowtree("demo", "-o", "taken")
    assert done.code == 1
    assert "taken" in done.err.splitlines()[-1]


def test_the_bundled_pair_is_small():
    files = list((Path(flowtree.cli.demo.__file__).parent / "demo").glob("*.jpg"))
    assert len(files) == 2
    assert sum(file.stat().st_size for file in files) < 700_000
