"""The measure of fidelity: exact cameras, faults found, the same numbers each time."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from PIL import Image

from benchmarks.__main__ import run
from benchmarks.cases import read_report
from benchmarks.likeness import measure_exact, measure_speed
from benchmarks.measure_truth import HELD_OUT, INPUTS, find_faults, load_truth, measure_truth
from benchmarks.watch_command import Watched
from flowtree.errors import InputError
from flowtree.geometry.projection import project
from flowtree.meshing.sweep_rings import sweep_rings
from flowtree.model.traces import FlowTraces
from tests.pictures import draw_tree
from tests.trees import hand_made_tree


def save_truth(folder: Path, *, size: tuple[int, int] = (160, 200), alpha: bool = True) -> Path:
    """A drawn tree in the form of the known ones: 6 m from the first row to the foot."""
    folder.mkdir(parents=True)
    views = []
    for yaw in sorted(INPUTS + HELD_OUT):
        picture = Image.fromarray(draw_tree(yaw, size=size))
        picture.convert("RGBA" if alpha else "RGB").save(folder / f"ortho_{yaw:03}.png")
        views.append(
            {
                "file": f"ortho_{yaw:03}.png",
                "yaw": yaw,
                "projection": "orthographic",
                "metres_per_pixel": 6.0 / (size[1] - 6),
                "foot_pixel": [size[0] / 2, size[1] - 6.0],
            }
        )
    for number in (0, 1):
        drawn = draw_tree(number, size=size)
        save_photo(drawn, folder / f"photo_{number}.jpg")
        Image.fromarray(drawn[..., 3]).save(folder / f"alpha_{number}.png")
        views.append({"file": f"photo_{number}.jpg", "yaw": 90 * number - 4.4, "projection": "perspective"})
    stems = [[[0, 0, 0, 0.15], [0, 5, 0, 0.03]], [[0, 2, 0, 0.08], [1.5, 4, 0.5, 0.02]]]
    known = {"name": folder.name, "height": 6.0, "leafy": False, "views": views, "stems": stems}
    (folder / "truth.json").write_text(json.dumps(known), encoding="utf-8")
    return folder


def save_photo(drawn: NDArray[np.uint8], file: Path) -> None:
    """The drawn tree before a blue sky."""
    alpha = drawn[..., 3:] / 255.0
    mixed = drawn[..., :3] * alpha + np.array([120.0, 170.0, 230.0]) * (1.0 - alpha)
    Image.fromarray(np.rint(mixed).astype(np.uint8)).save(file, quality=95)


@pytest.fixture(scope="module")
def data(tmp_path_factory):
    folder = tmp_path_factory.mktemp("data")
    save_truth(folder / "truth" / "drawn")
    return folder


@pytest.fixture(scope="module")
def pictures(tmp_path_factory):
    folder = tmp_path_factory.mktemp("pictures")
    for name in ("cutouts", "photos"):
        (folder / name).mkdir()
    Image.fromarray(draw_tree(3)).save(folder / "cutouts" / "elm.png")
    save_photo(draw_tree(4), folder / "photos" / "oak.jpg")
    return folder


_FEW = ["--set", "density.resolution=20", "flow.particle_count=150", "attraction.grid_height=64"]


def _run(data, part, *more):
    return run(["fidelity", "--data", str(data), "--part", part, *_FEW, *more])


@pytest.fixture
def easy(monkeypatch):
    """Bounds that any tree keeps."""
    for name in ("_INPUTS", "_WORST", "_HELD_OUT"):
        monkeypatch.setattr(measure_exact, name, 0.0)


@pytest.mark.usefixtures("easy")
def test_measures_draws_and_repeats_itself(data, tmp_path, capsys):
    first, second, folder = tmp_path / "1.json", tmp_path / "2.json", tmp_path / "pictures"
    assert _run(data, "truth", "--json", str(first), "-o", str(folder)) == 0
    said = capsys.readouterr().out
    assert _run(data, "truth", "--json", str(second), "--tree", "drawn") == 0
    assert first.read_bytes() == second.read_bytes()
    result = json.loads(first.read_text())
    scores = result["truth"]["drawn"]["tree"]
    for yaws, group in ((INPUTS, "inputs"), (HELD_OUT, "held_out")):
        assert scores[group] == pytest.approx(np.mean([scores[f"yaw_{yaw}"] for yaw in yaws]), abs=1e-4)
        assert f"{scores[group]:.3f}" in said
    assert result["parts"]["truth"][0]["items"] == {"drawn": scores["inputs"]}
    assert scores["inputs"] > scores["held_out"], "the other sides are other drawings"
    assert result["truth"]["drawn"]["faults"] == []
    assert result["machine"] in said
    table = (folder / "fidelity.md").read_text()
    assert f"{scores['inputs']:.3f} | yes" in table
    with (
        Image.open(folder / "truth_drawn.jpg") as sheet,
        Image.open(folder / "truth_drawn_around.jpg") as all_round,
    ):
        assert sheet.width > sheet.height
        assert all_round.width > all_round.height
    with pytest.raises(InputError):
        read_report(first)


@pytest.mark.parametrize("part", ["mattes", "loose", "wood", "strokes", "hole", "paint", "seeds"])
def test_every_part_of_known_trees_says_what_it_reached(data, part, tmp_path):
    _run(data, part, "--json", str(tmp_path / "figures.json"), "-o", str(tmp_path))
    rows = json.loads((tmp_path / "figures.json").read_text())["parts"][part]
    assert any(row["asked"] is not None for row in rows)
    for row in rows:
        assert row["items"] == {} or all(name.startswith("drawn") for name in row["items"])
        assert -1.0 <= row["reached"] <= 1.0
        assert row["measure"] in (tmp_path / "fidelity.md").read_text()
    assert (tmp_path / "matte_drawn_0.jpg").is_file() == (part == "mattes")
    assert (tmp_path / f"{part}_drawn.jpg").is_file() == (part in {"loose", "strokes", "hole"})


@pytest.mark.parametrize(
    ("part", "item", "sheet"), [("cutouts", "elm", "cutout"), ("photographs", "oak", "photo")]
)
def test_photographs_and_cutouts_become_trees_to_look_at(pictures, part, item, sheet, tmp_path):
    _run(pictures, part, "--json", str(tmp_path / "figures.json"), "-o", str(tmp_path))
    for row in json.loads((tmp_path / "figures.json").read_text())["parts"][part]:
        assert all(name.startswith(item) for name in row["items"])
    assert (tmp_path / f"{sheet}_{item}.jpg").is_file()


def test_the_speed_is_that_of_whole_commands(data, tmp_path, monkeypatch):
    ran = []

    def watch(command):
        ran.append(command)
        for file in command[1:3]:
            with Image.open(file) as photo:
                assert photo.size == (320, 400)
        return Watched(9.0 if len(ran) == 1 else 7.0, 1.0, 0.1)

    monkeypatch.setattr(measure_speed, "watch_command", watch)
    monkeypatch.setattr(measure_speed, "_LARGE", (320, 400))
    monkeypatch.setattr(measure_speed, "_ROUNDS", 1)
    _run(data, "speed", "--json", str(tmp_path / "figures.json"))
    whole, matte, mended = json.loads((tmp_path / "figures.json").read_text())["parts"]["speed"]
    assert whole["reached"] == 7.0, "the first run may compile"
    assert matte["reached"] > 0
    assert mended["reached"] > 0
    assert whole["unit"] == "s"


def test_a_mean_below_its_bound_is_a_failure(data, capsys):
    assert _run(data, "truth") == 1
    assert "not passed" in capsys.readouterr().out


@pytest.mark.usefixtures("easy")
def test_a_tree_with_a_fault_is_a_failure(data, monkeypatch, capsys):
    def broken(*inputs, **options):
        return dataclasses.replace(measure_truth(*inputs, **options), faults=("a hole in it",))

    monkeypatch.setattr(measure_exact, "measure_truth", broken)
    assert _run(data, "truth") == 1
    assert "faults of these trees.drawn 1.000" in capsys.readouterr().out


def test_missing_data_and_unknown_names_get_one_line(data, tmp_path, capsys):
    for arguments, words in (
        (["--data", str(tmp_path / "nowhere"), "--part", "truth"], "--data"),
        (["--data", str(data)], "--part"),
        (["--data", str(data), "--part", "truth", "--tree", "drown"], "did you mean 'drawn'?"),
        (["--data", str(data), "--part", "trouth"], "did you mean 'truth'?"),
    ):
        assert run(["fidelity", *arguments]) == 1
        said = capsys.readouterr()
        assert said.err.count("\n") == 1
        assert words in said.err


def test_a_picture_without_alpha_is_refused(tmp_path):
    with pytest.raises(InputError, match=r"ortho_000\.png: needs an alpha channel"):
        load_truth(save_truth(tmp_path / "opaque", alpha=False))


@pytest.mark.parametrize("size", [(160, 200), (400, 1280)])
def test_cameras_are_exact_also_in_scaled_pictures(tmp_path, size):
    truth = load_truth(save_truth(tmp_path / "drawn", size=size))
    assert sorted(truth.cameras) == sorted(INPUTS + HELD_OUT)
    for yaw, camera in truth.cameras.items():
        rows, columns = truth.alphas[yaw].shape
        assert (camera.height, camera.width) == (rows, columns)
        foot, top = project([[0.0, 0.0, 0.0], [0.0, truth.height, 0.0]], camera)
        np.testing.assert_allclose(foot, [columns / 2, rows * (1.0 - 6.0 / size[1])], rtol=1e-6)
        np.testing.assert_allclose(top, [columns / 2, 0.0], atol=1e-3)


def _traces_of(tree):
    skeleton = tree.skeleton
    steps = np.arange(len(skeleton.parent), dtype=np.int32)
    return FlowTraces(skeleton.parent, skeleton.points, skeleton.particles, steps)


def test_a_sound_tree_has_no_fault_and_a_hole_is_one():
    tree = hand_made_tree()
    tree = dataclasses.replace(tree, wood=sweep_rings(tree.skeleton))
    assert find_faults(tree, _traces_of(tree)) == []
    torn = dataclasses.replace(tree.wood, triangles=tree.wood.triangles[1:])
    assert find_faults(dataclasses.replace(tree, wood=torn), _traces_of(tree)) == [
        "the wood is not watertight"
    ]


@settings(deadline=None, max_examples=25)
@given(st.data())
def test_finds_every_loose_point_and_lost_particle(draw):
    tree = hand_made_tree()
    tree = dataclasses.replace(tree, wood=sweep_rings(tree.skeleton))
    traces = _traces_of(tree)
    count = len(traces.parent)
    node = draw.draw(st.integers(1, count - 1))
    parent = traces.parent.copy()
    parent[node] = draw.draw(st.one_of(st.just(-1), st.integers(node, count - 1)))
    assert "the traces are no tree with one root" in find_faults(
        tree, dataclasses.replace(traces, parent=parent)
    )
    fewer = traces.particles.copy()
    fewer[traces.parent[node]] = traces.particles[node] - 1
    assert "particles are lost on the way to the foot" in find_faults(
        tree, dataclasses.replace(traces, particles=fewer)
    )
