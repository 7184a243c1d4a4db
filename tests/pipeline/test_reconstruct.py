"""The whole pipeline on small pictures: what it promises, whatever the stages inside do."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

import flowtree
from flowtree.configuration import override_params
from flowtree.errors import CancelledError, InputError
from flowtree.export.write_glb import encode_glb
from flowtree.model.edit import PaintedEdit
from flowtree.model.photo import Photo
from flowtree.params import Params
from flowtree.photos.load_photo import load_photo
from flowtree.photos.read_picks import Picks
from flowtree.pipeline.build_report import report_bytes
from flowtree.pipeline.cache import StageCache
from flowtree.pipeline.photo_steps import run_matting, run_painting, run_preparing, run_strokes
from flowtree.pipeline.reconstruct import reconstruct
from flowtree.pipeline.stage import Job
from flowtree.pipeline.table import STAGES
from tests.pictures import draw_tree, save_pair

SMALL = override_params(
    Params(),
    [
        "density.resolution=20",
        "flow.particle_count=150",
        "attraction.grid_height=64",
        "attraction.seed_count=8",
    ],
)


@pytest.fixture(scope="module")
def pair(tmp_path_factory):
    return save_pair(tmp_path_factory.mktemp("pair"))


@pytest.fixture(scope="module")
def cache():
    """One for the module: most runs differ in little."""
    return StageCache(512)


@pytest.fixture(scope="module")
def made(pair, cache):
    return reconstruct(pair, height=6.0, params=SMALL, cache=cache)


def _photos(pair):
    for k, _ in enumerate(pair):
        pixels = draw_tree(k)
        yield Photo(pair[k].name, pixels[..., :3], pixels[..., 3].astype(np.float32) / np.float32(255))


def test_everything_on_the_way_is_returned(made):
    assert [camera.yaw for camera in made.cameras] == [0.0, 90.0]
    for several in (made.photos, made.mattes, made.graphs, made.fields):
        assert len(several) == 2
    assert made.tree.skeleton is made.skeleton
    assert made.tree.height == 6.0
    assert made.volume.density.sum() > 0
    parent = made.skeleton.parent
    assert parent[0] == -1
    assert (parent[1:] >= 0).all()
    assert (parent[1:] < np.arange(1, len(parent))).all()
    assert (made.traces.parent[1:] < np.arange(1, len(made.traces.parent))).all()


def test_the_report_has_the_form_of_the_design(made):
    report = json.loads(report_bytes(made.report))
    assert set(report) == {
        *("version", "seed", "device", "seconds", "peak_memory_mb", "views", "skeleton", "mesh", "leaves"),
        "warnings",
    }
    assert list(report["seconds"]) == [stage.name for stage in STAGES]
    assert {"nodes", "tips", "branches", "total_length_m", "trunk_radius_m", "particles"} == set(
        report["skeleton"]
    )
    assert report["mesh"]["watertight"] is True
    for view in report["views"]:
        assert {"file", "yaw", "soft_iou", "matte", "alignment"} == set(view)
        assert {"foot", "top", "straightened", "leaves_picture_at"} == set(view["alignment"])
        assert 0.4 < view["soft_iou"] <= 1.0
    assert report["peak_memory_mb"] > 0
    assert report["warnings"] == []


def test_equal_seeds_give_equal_bytes_and_others_differ(pair, made, cache):
    # Photos in memory are other sources than files, and there is no cache: all is computed anew.
    again = reconstruct(list(_photos(pair)), height=6.0, params=SMALL)
    assert encode_glb(again.tree) == encode_glb(made.tree)
    other = reconstruct(pair, height=6.0, params=SMALL, seed=1, cache=cache)
    assert encode_glb(other.tree) != encode_glb(made.tree)


def test_another_seed_computes_only_what_is_random_again(pair, made, cache):
    other = reconstruct(pair, height=6.0, params=SMALL, seed=1, cache=cache)
    assert other.mattes[0] is made.mattes[0]
    assert other.volume is made.volume
    assert other.traces is not made.traces


def test_one_photo_and_its_mirror_image(pair, cache):
    alone = reconstruct(pair[:1], height=6.0, params=SMALL, cache=cache)
    assert [camera.yaw for camera in alone.cameras] == [0.0, 90.0]
    assert np.array_equal(alone.mattes[1].alpha, alone.mattes[0].alpha[:, ::-1])
    assert np.array_equal(alone.photos[1].rgb, alone.photos[0].rgb[:, ::-1])
    assert any("mirror" in warning for warning in alone.report["warnings"])


def test_a_mirrored_view_takes_everything_drawn_with_it(made):
    photo, matte = made.photos[0], made.mattes[0]
    add = np.zeros(matte.alpha.shape, np.float32)
    add[20:40, 5:30] = 1.0
    width = matte.alpha.shape[1]
    edit = PaintedEdit(
        add=add, directions=(np.array([[10.0, 20.0], [30.0, 60.0]], np.float32),), reach=(9.0,)
    )
    stroke = np.array([[80.0, 190.0], [100.0, 20.0]], np.float32)
    job = Job(SMALL, 0, "cpu")
    plain = run_painting(job, photo, matte, edit, False)
    flipped = run_painting(job, photo, matte, edit, True)
    assert plain[1] is matte, "the paint is applied where the view is level"
    assert np.array_equal(flipped[1].alpha, plain[1].alpha[:, ::-1])
    assert np.array_equal(flipped[2].add, add[:, ::-1])
    (drawn,) = run_strokes(job, photo, (stroke,), True)
    for line, other in ((edit.directions[0], flipped[2].directions[0]), (stroke, drawn)):
        assert np.allclose(other[:, 0], width - line[:, 0])
        assert np.array_equal(other[:, 1], line[:, 1])


def test_painted_edits_strokes_and_mattes_reach_the_tree(pair, made, cache):
    height, width = made.mattes[0].alpha.shape
    erase = np.zeros((height, width), np.float32)
    erase[:, : width // 2 - 12] = 1.0
    edited = reconstruct(pair, height=6.0, params=SMALL, paint={0: PaintedEdit(erase=erase)}, cache=cache)
    assert edited.mattes[0].alpha[:, : width // 2 - 12].max() == 0.0
    left = edited.skeleton.points[:, 0].min()
    assert left > made.skeleton.points[:, 0].min() + 0.5
    assert edited.mattes[1] is made.mattes[1], "the other view is as it was"

    stroke = np.array([[width / 2, height - 20], [width - 20, height / 2]], np.float32)
    drawn = reconstruct(pair, height=6.0, params=SMALL, strokes=[(stroke,)], cache=cache)
    assert len(drawn.graphs[0].parent) != len(made.graphs[0].parent)
    assert drawn.graphs[1] is made.graphs[1]

    block = np.zeros((height, width), np.float32)
    block[10:-10, 60:100] = 0.9
    given = reconstruct(pair, height=6.0, params=SMALL, mattes=[block, None], cache=cache)
    assert np.array_equal(given.mattes[0].alpha, block)


def test_the_bark_has_the_colour_of_the_trunk(made):
    mean = made.tree.bark.base_color.reshape(-1, 3).astype(float).mean(axis=0)
    assert np.abs(mean - (96, 74, 52)).max() < 25


def test_progress_and_cancelling(pair):
    seen = []
    with pytest.raises(CancelledError):
        reconstruct(
            pair,
            params=SMALL,
            progress=lambda stage, share: seen.append((stage, share)),
            cancel=lambda: len(seen) > 4,
        )
    assert [share for _, share in seen] == sorted(share for _, share in seen)


def test_a_missing_height_is_said(pair, cache):
    made = reconstruct(pair, params=SMALL, cache=cache)
    assert made.tree.height == 10.0
    assert any("10 m is assumed" in warning for warning in made.report["warnings"])


def test_views_that_do_not_match_are_said(tmp_path, cache):
    tree = draw_tree(0)
    flag = np.zeros_like(tree)  # a pole with a small flag far up: nothing like the tree
    flag[4:-4, 76:84] = 255
    flag[4:30, 20:76] = 255
    for name, pixels in (("tree.png", tree), ("flag.png", flag)):
        Image.fromarray(pixels).save(tmp_path / name)
    files = [tmp_path / "tree.png", tmp_path / "flag.png"]
    made = reconstruct(files, height=6.0, params=SMALL, cache=cache)
    assert any("do not look like one tree" in warning for warning in made.report["warnings"])


def test_the_same_photo_twice_is_said(pair, cache):
    made = reconstruct([pair[0], pair[0]], height=6.0, params=SMALL, cache=cache)
    assert any("same photo" in warning for warning in made.report["warnings"])


def test_three_views(pair, cache):
    made = reconstruct([*pair, pair[0]], height=6.0, params=SMALL, cache=cache)
    assert [camera.yaw for camera in made.cameras] == [0.0, 60.0, 120.0]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"photos": []}, "photos"),
        ({"photos": "tree.jpg"}, "photos: must be a list"),
        ({"yaws": (0, 0)}, "yaw"),
        ({"yaws": (0, 180)}, "yaw"),
        ({"height": 0.0}, "height"),
        ({"height": float("nan")}, "height"),
        ({"seed": -1}, "seed"),
        ({"seed": 0.5}, "seed"),
        ({"strokes": {5: "a.svg"}}, "strokes: must belong to a photo"),
        ({"paint": ["a.png", "b.png", "c.png"]}, "paint: must belong to a photo"),
        ({"mattes": [np.full((7, 7), 0.5), None]}, r"matte of front\.png: must have shape"),
        ({"device": "abacus"}, "device: must be one of"),
        ({"photos": ["nowhere.jpg", "side.png"]}, "nowhere.jpg"),
    ],
)
def test_wrong_arguments_are_one_clear_line(pair, arguments, message):
    photos = arguments.pop("photos", pair)
    with pytest.raises(InputError, match=message) as caught:
        reconstruct(photos, params=SMALL, **arguments)
    assert "\n" not in str(caught.value)


def test_the_public_name_is_the_function():
    assert flowtree.reconstruct is reconstruct


def test_what_matting_prepares_serves_an_equal_photo(pair):
    photo = replace(load_photo(pair[0]), alpha=None)
    job = Job(Params(), 0, None)
    prepared = run_preparing(job, photo, None, Picks())
    again = replace(photo, rgb=photo.rgb.copy())
    ours = run_matting(job, again, prepared, None, None, Picks())
    assert (ours.alpha == run_matting(job, photo, None, None, None, Picks()).alpha).all()
    cut = replace(photo, alpha=np.ones(photo.rgb.shape[:2], np.float32))
    assert run_preparing(job, cut, None, Picks()) is None


def test_colours_picked_on_a_photo_are_that_photos_alone(pair, made, cache, tmp_path):
    opaque = [replace(load_photo(file), alpha=None) for file in pair]
    file = tmp_path / "picks.json"
    file.write_text(json.dumps({"strokes": [], "tree_colors": ["#5b4632"], "background_colors": ["#3c8c28"]}))
    cuts = []

    def note(stage, values):
        if stage == "matting":
            cuts.append(values["raw_cut"])

    for scribbles in (None, [file]):
        reconstruct(opaque, height=6.0, params=SMALL, scribbles=scribbles, cache=cache, made=note)
    plain, picked = cuts
    assert picked[0].alpha.sum() < 0.6 * plain[0].alpha.sum(), "leaves are background there"
    assert picked[1] is plain[1]
