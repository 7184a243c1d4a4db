"""The measure of the quad wood: a row a tree, closed, as thick as its skeleton, and smooth."""

from __future__ import annotations

import dataclasses
import json

import numpy as np
import pytest

from benchmarks import tree_table, wood
from benchmarks.__main__ import find_programs, run
from flowtree.meshing.connect_ramifications import connect_ramifications
from flowtree.params import MeshingParams
from flowtree.pipeline.reconstruct import Reconstruction
from tests.skeletons import random_skeleton, skeleton_of


def test_measures_a_tree_and_its_largest_branches(tmp_path, monkeypatch, capsys):
    made = random_skeleton(3, 600)
    monkeypatch.setattr(tree_table, "reconstruct", lambda *_, **__: _with(made))
    monkeypatch.setattr(wood, "_TIMED", 40)
    file = tmp_path / "wood.json"
    code = run(["wood", "--data", str(tmp_path / "none"), "--runs", "1", "--json", str(file)])
    head, rule, *rows, machine, said = capsys.readouterr().out.splitlines()
    assert len(rows) == 2
    assert head.count("|") == rule.count("|") == rows[0].count("|")
    assert "cores" in machine
    assert said.startswith("40 branches: quads ")
    fewer, whole = json.loads(file.read_text())["trees"]
    assert (fewer["tree"], whole["tree"]) == ("demo, fewer", "demo")
    assert whole["branches"] > fewer["branches"] == 40
    assert whole["closed"]
    assert fewer["closed"]
    assert code == (0 if fewer["seconds"] < 3.0 and fewer["ring_seconds"] < 0.3 else 1)


def test_measures_the_surface_not_itself():
    """A tree that is a tenth too thick is a tenth off and a fifth too heavy."""
    made = random_skeleton(5, 120, stubborn=0.95)
    row = wood.measure_wood("one", made)
    assert row.off_median < 0.03
    assert row.off_most < 0.12
    assert row.volume == pytest.approx(1.0, abs=0.05)
    thicker = dataclasses.replace(made, radius=np.float32(1.1) * made.radius)
    off, wanted, _ = wood._compare(connect_ramifications(thicker), made)
    assert np.median(off / wanted) == pytest.approx(1.1, abs=0.05)


def test_measures_a_branch_where_the_wood_has_it_go_on():
    """Of two equal branches the straight one goes on, though the other comes first; it begins as thick."""
    parent = np.array([-1, 0, 1, 1, 2, 3])
    points = np.array([[0, 0, 0], [0, 2, 0], [1.5, 3.5, 0], [0, 5, 0], [3, 5, 0], [0, 8, 0]], float)
    made = skeleton_of(parent, points, np.random.default_rng(0))
    assert made.particles[2] == made.particles[3]
    assert wood._goes_on(made).tolist() == [1, 3, 4, 5, -1, -1]
    assert wood.measure_wood("fork", made).off_most < 0.06


def test_measures_a_quad_at_the_nearest_node(monkeypatch):
    """Rings of a thick trunk span several nodes; a quad bears the highest, and may lie far below it."""
    trunk, fork = 90, 30
    parent = np.append(np.arange(trunk) - 1, [fork, trunk])
    points = [[0.0, 0.1 * k, 0.0] for k in range(trunk)] + [[1.0, 4.0, 0.0], [2.0, 5.0, 0.0]]
    made = skeleton_of(parent, np.array(points), np.random.default_rng(0))
    radius = np.where(np.arange(len(parent)) <= fork, 0.4, 0.2).astype(np.float32)
    made = dataclasses.replace(made, radius=radius)
    mesh = connect_ramifications(made, params=MeshingParams(root_flare=0.0))
    off, wanted, _ = wood._compare(mesh, made)
    assert (off / wanted).max() < 1.01
    monkeypatch.setattr(wood, "_SPANNED", 0)
    off, wanted, _ = wood._compare(mesh, made)
    assert (off / wanted).max() > 1.05


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_the_largest_branches_are_a_tree_of_their_own(seed):
    made = random_skeleton(seed, 200)
    for count in (1, 7, 30):
        kept = wood.keep_largest(made, count)
        assert wood.count_branches(kept) == count
        assert (kept.parent[1:] < np.arange(1, len(kept.parent))).all()
        assert kept.particles[0] == made.particles.max()
        assert not kept.points[0].any()


def test_an_open_surface_is_not_closed():
    mesh = connect_ramifications(random_skeleton(1, 20))
    assert wood.is_one_closed_surface(mesh)
    assert not wood.is_one_closed_surface(dataclasses.replace(mesh, quads=mesh.quads[1:]))
    turned = mesh.quads.copy()
    turned[0] = turned[0, ::-1]
    assert not wood.is_one_closed_surface(dataclasses.replace(mesh, quads=turned))


def test_knows_its_trees(tmp_path, capsys):
    assert "wood" in find_programs()
    assert run(["wood", "--data", str(tmp_path / "none"), "--tree", "dmeo"]) == 1
    assert "dmeo: must be a known tree" in capsys.readouterr().err


def _with(skeleton):
    """As much of a reconstruction as is measured."""
    made = object.__new__(Reconstruction)
    object.__setattr__(made, "skeleton", skeleton)
    return made
