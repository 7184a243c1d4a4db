"""Skeletons survive their files, and broken files get one clear line."""

from __future__ import annotations

import contextlib
import csv
import json
from pathlib import Path

import numpy as np
import pytest
import trimesh
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from flowtree.errors import InputError
from flowtree.export.export_skeleton import SKELETON_ENDINGS, export_skeleton
from flowtree.export.number_branches import number_branches
from flowtree.export.read_skeleton import read_skeleton
from flowtree.model.skeleton import Skeleton
from tests.export.skeletons import random_skeleton, skeletons
from tests.trees import hand_made_skeleton

quick = settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
ALL = ("parent", "points", "radius", "particles", "level", "twig")


def assert_same(one: Skeleton, other: Skeleton, names: tuple[str, ...] = ALL, first: int = 0) -> None:
    for name in names:
        a, b = getattr(one, name)[first:], getattr(other, name)[first:]
        assert a.dtype == b.dtype, name
        np.testing.assert_array_equal(a, b, err_msg=name)


@quick
@given(skeleton=skeletons)
def test_json_keeps_everything(tmp_path: Path, skeleton: Skeleton) -> None:
    path = tmp_path / "tree.json"
    export_skeleton(skeleton, path)
    assert_same(read_skeleton(path), skeleton)
    json.loads(path.read_text())


@quick
@given(skeleton=skeletons)
def test_swc_keeps_shape_and_thickness(tmp_path: Path, skeleton: Skeleton) -> None:
    path = tmp_path / "tree.SWC"
    export_skeleton(skeleton, path)
    assert_same(read_skeleton(path), skeleton, ("parent", "points", "radius", "twig"))


@quick
@given(skeleton=skeletons.filter(lambda skeleton: len(skeleton.parent) > 1))
def test_csv_keeps_every_segment(tmp_path: Path, skeleton: Skeleton) -> None:
    path = tmp_path / "tree.csv"
    export_skeleton(skeleton, path)
    again = read_skeleton(path)
    assert_same(again, skeleton, ("parent", "points", "radius"))
    assert_same(again, skeleton, ("particles", "level", "twig"), first=1)


@quick
@given(count=st.integers(1, 30), seed=st.integers(0, 1000))
def test_the_order_of_lines_does_not_matter(tmp_path: Path, count: int, seed: int) -> None:
    skeleton, path = random_skeleton(count, seed), tmp_path / "tree.swc"
    export_skeleton(skeleton, path)
    lines = path.read_text().splitlines()
    np.random.default_rng(seed).shuffle(lines)
    path.write_text("\n".join(lines))
    again = read_skeleton(path)
    assert (again.parent[1:] < np.arange(1, count)).all()

    # The same set of segments, wherever they stand in the arrays.
    def segments(s: Skeleton) -> set[tuple[float, ...]]:
        return {(*s.points[k], *s.points[p], s.radius[k]) for k, p in enumerate(s.parent.tolist()) if p >= 0}

    assert segments(again) == segments(skeleton)


def test_swc_derives_order_and_counts(tmp_path: Path) -> None:
    skeleton, path = hand_made_skeleton(), tmp_path / "tree.swc"
    export_skeleton(skeleton, path)
    assert_same(read_skeleton(path), skeleton)  # of a tree whose orders and counts follow the rules


def test_a_table_of_another_program_is_read(tmp_path: Path) -> None:
    path = tmp_path / "treeqsm.csv"
    path.write_text(
        "Radius,length,StartX,StartY,StartZ,axis_x,axis_y,axis_z,parent,SurfCov,species,BranchOrder\n"
        "0.2,1,5,0,5,0,1,0,0,NaN,oak,0\n0.1,2,5,1,5,0,1,0,1,1,oak,0\n0.05,1,5,1,5,1,0,0,1,1,oak,1\n"
    )
    skeleton = read_skeleton(path)
    np.testing.assert_allclose(skeleton.points, [[0, 0, 0], [0, 1, 0], [0, 3, 0], [1, 1, 0]])
    assert skeleton.parent.tolist() == [-1, 0, 1, 1]
    assert skeleton.level.tolist() == [0, 0, 0, 1]
    assert skeleton.particles.tolist() == [2, 2, 1, 1]
    np.testing.assert_allclose(skeleton.radius, [0.2, 0.2, 0.1, 0.05])


@quick
@given(skeleton=skeletons)
def test_branches_are_paths_that_cover_the_tree(skeleton: Skeleton) -> None:
    numbers = number_branches(skeleton)
    assert sorted(set(numbers.branch.tolist())) == list(range(1, int(numbers.branch.max()) + 1))
    for branch in range(1, int(numbers.branch.max()) + 1):
        nodes = np.flatnonzero(numbers.branch == branch)
        nodes = nodes[np.argsort(numbers.position[nodes])]
        first = 0 if branch == 1 else 1
        assert numbers.position[nodes].tolist() == list(range(first, first + len(nodes)))
        assert numbers.extension[nodes].tolist() == [*nodes[1:].tolist(), -1]
        assert skeleton.parent[nodes[1:]].tolist() == nodes[:-1].tolist()
        assert len(set(skeleton.level[nodes].tolist())) == 1


def test_cylinders_are_where_the_segments_are(tmp_path: Path) -> None:
    skeleton, path = hand_made_skeleton(), tmp_path / "tree.csv"
    export_skeleton(skeleton, path)
    with path.open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == len(skeleton.parent) - 1
    for k, row in enumerate(rows, 1):
        start = np.array([float(row[f"start_{axis}"]) for axis in "xyz"])
        axis = np.array([float(row[f"axis_{axis}"]) for axis in "xyz"])
        np.testing.assert_allclose(start + float(row["length"]) * axis, skeleton.points[k], atol=1e-6)
        parent = int(row["parent"])
        assert parent == skeleton.parent[k]
        if parent:
            np.testing.assert_allclose(start, skeleton.points[parent])
        if int(row["extension"]):
            assert int(rows[int(row["extension"]) - 1]["parent"]) == k


def test_trimesh_reads_the_points_of_the_ply(tmp_path: Path) -> None:
    skeleton, path = hand_made_skeleton(), tmp_path / "tree.ply"
    export_skeleton(skeleton, path)
    np.testing.assert_array_equal(trimesh.load(path).vertices, skeleton.points)


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("a.swc", "", "needs a node"),
        ("a.swc", "1 0 0 0 0 1 -1\n2 0 0 1 0 1 -1\n", "2 roots"),
        ("a.swc", "1 0 0 0 0 1 2\n2 0 0 1 0 1 1\n", "circle"),
        ("a.swc", "1 0 0 0 0 1 -1\n2 0 0 1 0 1 3\n3 0 0 2 0 1 2\n", "circle"),
        ("a.swc", "1 0 0 0 0 1 1\n", "circle"),
        ("a.swc", "1 0 0 0 0 1 -1\n2 0 0 1 0 1 7\n", "parent 7"),
        ("a.swc", "1 0 0 0 0 1 -1\n1 0 0 1 0 1 1\n", "a number twice"),
        ("a.swc", "1 0 0 0 nan 1 -1\n", "must be finite"),
        ("a.swc", "1 0 0 0 0 -1 -1\n", "at least 0"),
        ("a.swc", "1 0 0 0 1e300 1 -1\n", "at most 1e[+]06"),
        ("a.swc", "# fine\n1 0 0 0 0 -1\n", "line 2"),
        ("a.swc", "1 0 x 0 0 1 -1\n", "line 1"),
        ("a.csv", "", "needs the columns"),
        ("a.csv", "radius,length\n1,2\n", "none for start_x"),
        ("a.csv", "HEAD\n", "needs a cylinder"),
        ("a.csv", "HEAD\n1,1,0,0,0,0,1,0,2\n1,1,0,0,0,0,1,0,1\n", "without parent"),
        ("a.csv", "HEAD\n1,1,0,0,0,0,1,0,0\n1,1,3,0,0,0,1,0,0\n", "3 m apart"),
        ("a.csv", "HEAD\n1,1,0,0,0,0,1,0,0\n1,1,0,0,0,0,1,0,2\n", "circle"),
        ("a.csv", "HEAD\n1,1,0,0,0,0,1,0,0\n1,1,0,0,0,0,1,0,9\n", "below 3"),
        ("a.csv", "HEAD\n1,1,0,0,nan,0,1,0,0\n", "must be finite"),
        ("a.csv", "HEAD\n1,1,0,0,0,0,1,0\n", "line 2"),
        ("a.csv", "HEAD\n1,1,0,0,tree,0,1,0,0\n", "line 2"),
        ("a.json", "{", "must be JSON"),
        ("a.json", "[" * 100_000, "must be JSON"),
        ("a.json", "[]", "flowtree skeleton"),
        ("a.json", '{"format": "flowtree skeleton"}', "needs the lists"),
        ("a.txt", "", "must end in .swc, .csv, .json"),
        ("a", "", "no ending"),
    ],
)
def test_a_broken_file_gets_one_clear_line(tmp_path: Path, name: str, text: str, message: str) -> None:
    head = "radius,length,start_x,start_y,start_z,axis_x,axis_y,axis_z,parent"
    path = tmp_path / name
    path.write_text(text.replace("HEAD", head))
    with pytest.raises(InputError, match=message) as caught:
        read_skeleton(path)
    assert str(caught.value).startswith(name)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"parent": [-1, -1]}, "2 roots"),
        ({"parent": [1, 0]}, "circle"),
        ({"parent": [-1, 0.5]}, "whole numbers"),
        ({"parent": [-1, 2**70]}, "whole numbers"),
        ({"parent": [-2, 0]}, "at least -1"),
        ({"parent": []}, "needs a node"),
        ({"points": [[0, 0, 0]]}, "shape"),
        ({"points": [[0, 0, 0], [0, 0]]}, "equal length"),
        ({"points": [["a", 0, 0], [0, 0, 0]]}, "numbers"),
        ({"radius": [1, float("nan")]}, "finite"),
        ({"radius": [1, 2, 3]}, "shape"),
        ({"particles": [1, 2**40]}, "at most"),
        ({"level": None}, "needs the lists"),
    ],
)
def test_broken_arrays_in_json_get_one_clear_line(tmp_path: Path, change: dict, message: str) -> None:
    path = tmp_path / "tree.json"
    export_skeleton(random_skeleton(2, 0), path)
    path.write_text(json.dumps(json.loads(path.read_text()) | change))
    with pytest.raises(InputError, match=message) as caught:
        read_skeleton(path)
    assert "\n" not in str(caught.value)


@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data(), ending=st.sampled_from([".swc", ".csv", ".json"]))
def test_damage_is_read_or_refused_never_a_crash(tmp_path: Path, data: st.DataObject, ending: str) -> None:
    path = tmp_path / f"tree{ending}"
    export_skeleton(random_skeleton(4, 1), path)
    content = bytearray(path.read_bytes())
    for _ in range(data.draw(st.integers(1, 4))):
        at = data.draw(st.integers(0, len(content)))
        content[at : at + data.draw(st.integers(0, 9))] = data.draw(
            st.sampled_from(
                [b"-", b"9", b"nan", b",", b"\n", b"\xff", b"1e999", b"\0", b'"', b"[", b"-1 ", b"9" * 30]
            )
        )
    path.write_bytes(content)
    with contextlib.suppress(InputError):
        skeleton = read_skeleton(path)
        assert skeleton.parent[0] == -1
        assert (skeleton.parent[1:] < np.arange(1, len(skeleton.parent))).all()
        assert np.isfinite(skeleton.points).all()


def test_a_missing_file_and_bytes_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="No such file"):
        read_skeleton(tmp_path / "missing.swc")
    (tmp_path / "bytes.swc").write_bytes(b"\xff\xfe\xfd")
    with pytest.raises(InputError, match="no text"):
        read_skeleton(tmp_path / "bytes.swc")


def test_writers_refuse_what_nobody_could_read(tmp_path: Path) -> None:
    skeleton = random_skeleton(3, 0)
    with pytest.raises(InputError, match=r"must end in \.swc, \.csv, \.ply, \.json, but got \.xyz"):
        export_skeleton(skeleton, tmp_path / "tree.xyz")
    with pytest.raises(InputError, match="needs a segment"):
        export_skeleton(random_skeleton(1, 0), tmp_path / "tree.csv")
    skeleton.points[1, 1] = np.nan
    for ending in SKELETON_ENDINGS:
        with pytest.raises(InputError, match="must be finite"):
            export_skeleton(skeleton, tmp_path / f"tree{ending}")
    broken = random_skeleton(3, 0)
    broken.parent[1] = 2
    with pytest.raises(InputError, match="parents first"):
        export_skeleton(broken, tmp_path / "tree.swc")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("ending", SKELETON_ENDINGS)
def test_the_same_skeleton_gives_the_same_bytes(tmp_path: Path, ending: str) -> None:
    for name in ("a", "b"):
        export_skeleton(random_skeleton(30, 3), tmp_path / f"{name}{ending}")
    assert (tmp_path / f"a{ending}").read_bytes() == (tmp_path / f"b{ending}").read_bytes()
