"""The README names only options, parameters and names that there are."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np

import flowtree
from flowtree.configuration import override_params
from flowtree.model.photo import Photo
from flowtree.params import Params
from flowtree.photos.read_marks import read_marks

README = (Path(__file__).parents[2] / "README.md").read_text(encoding="utf-8")
COMMANDS = ("demo", "reconstruct", "grow", "render", "matte", "params", "inspect", "warmup")


def test_every_option_is_known(flowtree):
    known = {"--help", "--json", "--part"}  # the latter two are the benchmarks' own
    for command in COMMANDS:
        known |= set(re.findall(r"--[a-z]+", flowtree(command, "--help").out))
    assert set(re.findall(r"(?<![-\w])--[a-z]+", README)) <= known


def test_every_parameter_set_is_one():
    assignments = re.findall(r"--set ([\w.]+=[\w.]+)", README)
    assert assignments
    override_params(Params(), assignments)


def test_every_public_name_is_there():
    names = set(re.findall(r"\bflowtree\.([A-Za-z]\w*)\(", README))
    assert "ViewMarks" in names
    assert names <= set(flowtree.__all__)


def test_the_marks_are_read(tmp_path):
    (example,) = re.findall(r'`(\{"strokes".*\})`', README)
    (tmp_path / "marks.json").write_text(example)
    photo = Photo("tree.jpg", np.zeros((1000, 700, 3), np.uint8))
    marks = read_marks(tmp_path / "marks.json", photo)
    given = json.loads(example)
    assert [list(marks.foot), marks.top, list(marks.fork)] == [
        given[name] for name in ("foot", "top", "fork")
    ]
    assert marks.seeds.tolist() == given["seeds"]
