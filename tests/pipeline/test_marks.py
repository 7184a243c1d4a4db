"""What a person points at reaches camera and graph, of the view it belongs to and no other."""

from __future__ import annotations

import json

import numpy as np
import pytest
from PIL import Image

from flowtree.configuration import override_params
from flowtree.errors import InputError
from flowtree.geometry.projection import pixels_to_plane
from flowtree.model.marks import ViewMarks
from flowtree.params import Params
from flowtree.pipeline.cache import StageCache
from flowtree.pipeline.reconstruct import reconstruct
from tests.pictures import draw_tree, save_pair

SMALL = override_params(
    Params(),
    [
        "density.resolution=16",
        "flow.particle_count=100",
        "attraction.grid_height=64",
        "attraction.seed_count=6",
        "twigs.most=50",
        "leaves.most=50",
    ],
)
HEIGHT = 6.0


@pytest.fixture(scope="module")
def cache():
    return StageCache(512)


@pytest.fixture(scope="module")
def pair(tmp_path_factory):
    return save_pair(tmp_path_factory.mktemp("pair"))


@pytest.fixture(scope="module")
def made(pair, cache):
    return reconstruct(pair, height=HEIGHT, params=SMALL, cache=cache)


def _write(folder, content):
    file = folder / "marks.json"
    file.write_text(json.dumps(content))
    return file


def _to_segments(places, camera, graph):
    """Distances [m] of places (k, 2) [working pixels] to the nearest segment of the graph."""
    points = pixels_to_plane(places, camera)
    start, end = graph.points[graph.parent[1:]].astype(float), graph.points[1:].astype(float)
    along = end - start
    share = ((points[:, None] - start) * along).sum(axis=2) / np.maximum((along**2).sum(axis=1), 1e-12)
    nearest = start + np.clip(share, 0, 1)[..., None] * along
    return np.linalg.norm(points[:, None] - nearest, axis=2).min(axis=1)


def _stem(graph):
    """The nodes from the root up to the first fork."""
    children = np.bincount(graph.parent[1:], minlength=len(graph.parent))
    node, stem = 0, [0]
    while children[node] == 1:
        node = int(np.flatnonzero(graph.parent == node)[0])
        stem.append(node)
    return stem


def test_a_given_foot_and_top_are_the_camera_exactly(pair, made, cache, tmp_path):
    file = _write(tmp_path, {"foot": [70.5, 180], "top": 30})
    marked = reconstruct(pair, height=HEIGHT, params=SMALL, strokes={0: file}, cache=cache)
    camera = marked.cameras[0]
    assert camera.foot == (70.5, 180.0)
    assert camera.metres_per_pixel == HEIGHT / 150.0
    assert marked.cameras[1] is made.cameras[1], "the other view is as it was"
    assert marked.report["views"][0]["matte"]["foot_pixel"] == [70.5, 180.0]
    assert marked.mattes[0] is made.mattes[0], "marks change no matte"


def test_marks_are_in_pixels_of_the_original(cache, tmp_path):
    large = Image.fromarray(draw_tree(0)).resize((640, 800))
    large.save(tmp_path / "large.png")
    params = override_params(SMALL, ["photos.working_height=200"])
    file = _write(tmp_path, {"foot": [320, 760], "top": 40})
    marked = reconstruct([tmp_path / "large.png"], height=HEIGHT, params=params, strokes=[file], cache=cache)
    assert marked.cameras[0].foot == (80.0, 190.0)
    assert marked.cameras[0].metres_per_pixel == HEIGHT / 180.0


def test_a_mirrored_view_mirrors_its_marks(pair, cache):
    marks = ViewMarks(
        foot=(70.0, 190.0), top=10.0, fork=(75.0, 120.0), seeds=np.array([[50, 60]], np.float32)
    )
    params = override_params(SMALL, ["attraction.seed_count=0"])
    made = reconstruct(pair[:1], height=HEIGHT, params=params, marks=[marks], cache=cache)
    front, back = made.cameras
    assert front.foot == (70.0, 190.0)
    assert back.foot == (160.0 - 70.0, 190.0)
    assert back.metres_per_pixel == front.metres_per_pixel
    mirrored = np.array([[160.0 - 75.0, 120.0], [160.0 - 50.0, 60.0]])
    assert _to_segments(mirrored, back, made.graphs[1]).max() < 0.1


@pytest.mark.parametrize("fork", [(72, 150), (95, 120)])
def test_the_trunk_passes_through_a_given_fork(pair, made, cache, tmp_path, fork):
    file = _write(tmp_path, {"fork": fork})
    marked = reconstruct(pair, height=HEIGHT, params=SMALL, strokes=[file], cache=cache)
    graph, camera = marked.graphs[0], marked.cameras[0]
    assert camera == made.cameras[0], "a fork moves no camera"
    stem = graph.points[_stem(graph)]
    place = pixels_to_plane([fork], camera)[0]
    assert np.linalg.norm(stem - place, axis=1).min() < 1e-3
    assert marked.graphs[1] is made.graphs[1]


def test_seeds_by_hand_are_tips_alone_or_with_the_automatic_ones(pair, cache, tmp_path):
    seeds = np.array([[40.0, 90.0], [80.0, 40.0], [125.0, 80.0]])
    file = _write(tmp_path, {"seeds": seeds.tolist()})
    cell = HEIGHT / SMALL.attraction.grid_height
    for options, count in (
        (["attraction.seed_count=0"], 3),
        (["attraction.automatic=false"], 3),
        ([], None),
    ):
        params = override_params(SMALL, options)
        made = reconstruct(pair, height=HEIGHT, params=params, marks={0: file, 1: file}, cache=cache)
        graph, camera = made.graphs[0], made.cameras[0]
        tips = np.setdiff1d(np.arange(len(graph.parent)), graph.parent)
        places = pixels_to_plane(seeds, camera)
        apart = np.linalg.norm(places[:, None] - graph.points[tips][None], axis=2).min(axis=1)
        assert apart.max() < cell
        assert count is None or len(tips) == count
        assert count is not None or len(tips) > len(seeds)


def test_one_file_gives_strokes_and_marks(pair, cache, tmp_path):
    stroke = [[80.0, 150.0], [120.0, 100.0]]
    file = _write(tmp_path, {"strokes": [{"points": stroke}], "foot": [81, 192], "top": 8})
    made = reconstruct(pair, height=HEIGHT, params=SMALL, strokes=[file], cache=cache)
    assert made.cameras[0].foot == (81.0, 192.0)
    assert _to_segments(stroke, made.cameras[0], made.graphs[0]).max() < 1e-3


def test_marks_from_python_go_before_those_of_the_strokes(pair, cache, tmp_path):
    file = _write(tmp_path, {"foot": [81, 192], "top": 8})
    marks = {0: ViewMarks(foot=(79.0, 188.0))}
    made = reconstruct(pair, height=HEIGHT, params=SMALL, strokes=[file], marks=marks, cache=cache)
    assert made.cameras[0].foot == (79.0, 188.0)


def test_a_changed_mark_computes_again_what_hangs_on_it(pair, cache):
    def run(marks):
        return reconstruct(pair, height=HEIGHT, params=SMALL, marks=[marks], cache=cache)

    first, again = run(ViewMarks(foot=(80.0, 190.0))), run(ViewMarks(foot=(80.0, 190.0)))
    assert again.tree is first.tree
    other = run(ViewMarks(foot=(82.0, 190.0)))
    assert other.mattes[0] is first.mattes[0]
    assert other.cameras[0] != first.cameras[0]
    assert other.volume is not first.volume


def test_drawn_strokes_leave_camera_and_volume_alone(pair, made, cache):
    stroke = np.array([[80.0, 150.0], [120.0, 100.0]], np.float32)
    drawn = reconstruct(pair, height=HEIGHT, params=SMALL, strokes=[(stroke,)], cache=cache)
    assert drawn.volume is made.volume
    assert drawn.graphs[0] is not made.graphs[0]


def test_strokes_beside_marks_in_one_file_leave_camera_and_volume_alone(pair, cache, tmp_path):
    def run(strokes):
        file = _write(tmp_path, {"strokes": strokes, "foot": [81, 192]})
        return reconstruct(pair, height=HEIGHT, params=SMALL, strokes=[file], cache=cache)

    first, again = run([]), run([{"points": [[80.0, 150.0], [120.0, 100.0]]}])
    assert again.cameras[0].foot == (81.0, 192.0)
    assert again.volume is first.volume
    assert again.graphs[0] is not first.graphs[0]
    assert again.graphs[1] is first.graphs[1]


@pytest.mark.parametrize(
    ("marks", "message"),
    [
        ({0: {"foot": (1, 2)}}, r"marks of front\.png: must be ViewMarks"),
        ({1: ViewMarks(foot=(500.0, 2.0))}, r"marks of side\.png, foot: must lie in the photo"),
        ({5: ViewMarks()}, "marks: must belong to a photo"),
        ({0: "drawn.svg"}, r"drawn\.svg"),
        ({0: ViewMarks(fork=(80.0, 199.0))}, "target: must lie above the foot"),
        ({0: ViewMarks(foot=(80.0, 3.0))}, "foot: must lie below the top"),
        ({0: ViewMarks(foot=(80.0, 100.0), top=95.0)}, "at least 16 pixels"),
    ],
)
def test_wrong_marks_are_one_clear_line(pair, cache, marks, message):
    with pytest.raises(InputError, match=message) as caught:
        reconstruct(pair, height=HEIGHT, params=SMALL, marks=marks, cache=cache)
    assert "\n" not in str(caught.value)


def test_marks_far_from_the_tree_still_make_one(pair, cache):
    """Whatever is pointed at inside the picture, the result is a sound tree."""
    marks = ViewMarks((5.0, 199.0), 1.0, (150.0, 10.0), np.array([[0, 0], [160, 200], [3, 199]], np.float32))
    made = reconstruct(pair, height=HEIGHT, params=SMALL, marks=[marks], cache=cache)
    parent = made.skeleton.parent
    assert parent[0] == -1
    assert (parent[1:] < np.arange(1, len(parent))).all()
    assert np.isfinite(made.skeleton.points).all()
