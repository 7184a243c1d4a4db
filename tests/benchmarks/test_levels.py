"""The measure of levels and impostors: a row a tree, likenesses that are shares, a file of the same."""

from __future__ import annotations

import functools
import json

from benchmarks import levels, tree_table
from benchmarks.__main__ import find_programs, run
from flowtree.configuration import override_params
from flowtree.params import Params
from flowtree.pipeline.reconstruct import reconstruct
from tests.pictures import save_pair


def test_measures_the_bundled_pair_where_there_is_no_data(tmp_path, monkeypatch, capsys):
    small = override_params(Params(), ["flow.particle_count=600", "leaves.most=3000"])
    monkeypatch.setattr(tree_table, "reconstruct", functools.partial(reconstruct, params=small))
    monkeypatch.setattr(tree_table, "PAIR", save_pair(tmp_path))
    for name, fewer in {"_RUNS": 1, "_SIZE": 96, "_YAWS": (20.0,), "_BETWEEN": (20.0,)}.items():
        monkeypatch.setattr(levels, name, fewer)
    file = tmp_path / "levels.json"
    assert run(["levels", "--data", str(tmp_path / "none"), "--json", str(file)]) == 0
    head, rule, *rows, machine = capsys.readouterr().out.splitlines()
    assert head.count("|") == rule.count("|") == rows[0].count("|")
    assert "cores" in machine
    (tree,) = json.loads(file.read_text())["trees"]
    assert tree["tree"] == "demo"
    assert tree["triangles"] == sorted(tree["triangles"], reverse=True)
    assert all(0.2 < share <= 1.0 for share in (*tree["likeness"], tree["crossed"], tree["octahedral"]))
    assert abs(tree["loss"]) < 0.05
    assert tree["megabytes"] < 10
    assert all(tree[name] >= 0 for name in tree if name.endswith("_seconds"))


def test_knows_its_trees(tmp_path, capsys):
    assert "levels" in find_programs()
    assert run(["levels", "--data", str(tmp_path / "none"), "--tree", "dmeo"]) == 1
    assert "dmeo: must be a known tree" in capsys.readouterr().err
